#pragma once
// What the numerical tests share: small meshes on any partition, random states that are the same on every
// rank, and the way from distributed fields and matrices to whole ones in original order.
#include "partition/distributed_mesh.hpp"
#include "partition/grid.hpp"
#include "src/linear/vertex_matrix.hpp"
#include "src/state/cloth.hpp"
#include "tests/meshes.hpp"

#include <Eigen/Dense>
#include <mpi.h>

#include <functional>
#include <random>

namespace taut::test {

using Dense = Eigen::MatrixXd;
using Column = Eigen::VectorXd;
using MakeMesh = std::function<MeshSlab(MPI_Comm)>;

/// Numbers in [-size, size], the same on every rank.
inline std::vector<double> random_numbers(Global count, double size, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> number(-size, size);
  std::vector<double> numbers(count);
  for (double& n : numbers) n = number(random);
  return numbers;
}

inline std::vector<Vec3> random_vectors(Global count, double size, unsigned seed) {
  const std::vector<double> numbers = random_numbers(3 * count, size, seed);
  std::vector<Vec3> vectors;
  for (Global i = 0; i < count; ++i)
    vectors.emplace_back(numbers[3 * i], numbers[3 * i + 1], numbers[3 * i + 2]);
  return vectors;
}

/// Every kind of cell: a distorted, uneven grid of 5 x 4 vertices, two triangles at its right border and a
/// tail of three lines at a corner. 24 vertices about 0.25 m apart.
inline MeshSlab mixed_mesh(MPI_Comm comm) {
  MeshSlab grid = make_grid(self, {1.0, 0.75}, {5, 4});
  std::vector<Vec3> points = grid.rest_positions;
  std::vector<Cell> cells = grid.cell;
  points.insert(points.end(), {{1.2, 0.25, 0}, {1.2, 0.9, 0}, {1.4, 1.0, 0}, {1.7, 1.1, 0}});
  cells.insert(cells.end(), {{{9, 4, 20, -1}}, {{14, 9, 20, -1}}});
  cells.insert(cells.end(), {{{19, 21, -1, -1}}, {{21, 22, -1, -1}}, {{22, 23, -1, -1}}});
  const auto noise = random_vectors(Global(points.size()), 0.05, 1);
  for (std::size_t i = 0; i < points.size(); ++i) points[i] += noise[i];
  return slab_of_whole(comm, points, cells);
}

/// Triangles alone: a grid of 5 x 4 vertices, cut along both diagonals in turn, distorted in space.
inline MeshSlab triangle_mesh(MPI_Comm comm) {
  const MeshSlab grid = make_grid(self, {1.0, 0.75}, {5, 4}, GridCells::alternating_triangles);
  std::vector<Vec3> points = grid.rest_positions;
  const auto noise = random_vectors(Global(points.size()), 0.05, 2);
  for (std::size_t i = 0; i < points.size(); ++i) points[i] += noise[i];
  return slab_of_whole(comm, points, grid.cell);
}

/// A flat sheet of quads whose cells from the fourth column on are triangles.
inline MeshSlab quads_and_triangles(MPI_Comm comm) {
  const MeshSlab grid = make_grid(self, {0.8, 0.6}, {9, 7}, GridCells::quads);
  std::vector<Cell> cells;
  for (std::size_t c = 0; c < grid.cell.size(); ++c) {
    const auto& v = grid.cell[c].vertices;
    if (c % 8 < 3)
      cells.push_back(grid.cell[c]);
    else if (c % 2 == 0)
      cells.insert(cells.end(), {{{v[0], v[1], v[2], -1}}, {{v[0], v[2], v[3], -1}}});
    else
      cells.insert(cells.end(), {{{v[0], v[1], v[3], -1}}, {{v[1], v[2], v[3], -1}}});
  }
  return slab_of_whole(comm, grid.rest_positions, cells);
}

/// Owners of all vertices, in ways no partitioner would choose: scattered, all on the last rank, and
/// scattered over every second rank, so that the others are empty.
inline std::vector<std::vector<int>> odd_owners(Global vertices, int ranks) {
  std::vector<std::vector<int>> all(4, std::vector<int>(vertices));
  std::mt19937 random(7);
  for (Global i = 0; i < vertices; ++i) {
    all[0][i] = int(random() % unsigned(ranks));
    all[1][i] = int(random() % unsigned(ranks));
    all[2][i] = ranks - 1;
    all[3][i] = 2 * int(random() % unsigned((ranks + 1) / 2));
  }
  return all;
}

/// `owners` of all vertices.
inline DistributedMesh distribute_by(MPI_Comm comm, const MeshSlab& slab, const std::vector<int>& owners,
                                     ConstrainedEdges constrained = ConstrainedEdges::threads) {
  const auto first = owners.begin() + slab.vertices.first;
  return distribute(comm, slab, find_topology(comm, slab, constrained), {first, first + slab.vertices.count});
}

/// The whole mesh on this rank.
inline DistributedMesh serial(const MakeMesh& make,
                              ConstrainedEdges constrained = ConstrainedEdges::threads) {
  const MeshSlab slab = make(self);
  return distribute_by(self, slab, std::vector<int>(slab.vertices.total, 0), constrained);
}

/// Calls `check(mesh)` for the mesh on each of the odd partitions over all ranks.
inline void on_odd_partitions(const MakeMesh& make, const std::function<void(DistributedMesh)>& check,
                              ConstrainedEdges constrained = ConstrainedEdges::threads) {
  const MeshSlab slab = make(world);
  for (const auto& owners : odd_owners(slab.vertices.total, size_of(world)))
    check(distribute_by(world, slab, owners, constrained));
}

/// The values of local entities from those of all, in original order.
template<class T>
std::vector<T> local(const IndexMap& map, const std::vector<T>& all) {
  std::vector<T> values;
  for (const Global i : map.original) values.push_back(all[i]);
  return values;
}

/// The values of all entities (numbers, or vectors of three numbers) in original order, on every rank, to the
/// bit.
template<class T>
Column gather(MPI_Comm comm, const IndexMap& map, std::span<const T> owned) {
  constexpr int n = sizeof(T) / sizeof(double);
  Column all = Column::Zero(n * map.total);
  for (Local i = 0; i < map.owned; ++i)
    for (int k = 0; k < n; ++k) all[n * map.original[i] + k] = reinterpret_cast<const double*>(&owned[i])[k];
  sum_in_place(comm, {all.data(), std::size_t(all.size())});
  return all;
}

/// The whole matrix, three rows a vertex in original order, column by column from products with unit vectors.
inline Dense gather(const DistributedMesh& mesh, const VertexMatrix& matrix) {
  const IndexMap& map = mesh.vertices;
  Dense all = Dense::Zero(3 * map.total, 3 * map.total);
  std::vector<Vec3> x(map.size()), y(map.size());
  for (Global column = 0; column < all.cols(); ++column) {
    for (Local i = 0; i < map.size(); ++i)
      x[i] = map.original[i] == column / 3 ? Vec3(Vec3::Unit(column % 3)) : Vec3(Vec3::Zero());
    matrix.multiply(x, y);
    for (Local i = 0; i < map.owned; ++i) all.block<3, 1>(3 * map.original[i], column) = y[i];
  }
  sum_in_place(mesh.comm, {all.data(), std::size_t(all.size())});
  return all;
}

/// Largest difference over the largest value expected.
inline double relative_error(const Dense& found, const Dense& expected) {
  return (found - expected).cwiseAbs().maxCoeff() / expected.cwiseAbs().maxCoeff();
}

} // namespace taut::test
