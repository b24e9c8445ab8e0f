// Yarns, and the exact solve along them, on adversarial partitions.
#include "partition/fetch.hpp"
#include "partition/grid.hpp"
#include "src/linear/yarn_factor.hpp"
#include "tests/meshes.hpp"

#include <Eigen/Dense>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <random>

using namespace taut;
using namespace taut::test;
using testing::ElementsAre;

namespace {

DistributedMesh spread(MPI_Comm comm, const MeshSlab& slab, const std::vector<int>& owners) {
  return distribute(comm, slab, find_topology(comm, slab), owners);
}

/// A number in (-1, 1) that depends on two original edge numbers alone.
double noise(Global a, Global b) {
  std::seed_seq seed{std::min(a, b), std::max(a, b)};
  std::mt19937 random(seed);
  return std::uniform_real_distribution<double>(-1, 1)(random);
}

double coupling(Global a, Global b) { return 0.9 * noise(a, b); }
double diagonal(Global e) {
  return 3.2 + noise(e, e);
} // above twice the largest coupling: the blocks are SPD

/// The matrix along the yarns of `mesh`, made of the functions above.
YarnTridiagonal matrix_on(const DistributedMesh& mesh, const Yarns& yarns) {
  const auto& original = mesh.edges.original;
  YarnTridiagonal matrix;
  for (const YarnSegment& s : yarns.segments)
    for (Local e = s.begin; e < s.end; ++e) {
      matrix.diagonal.push_back(diagonal(original[e]));
      matrix.to_previous.push_back(e > s.begin ? coupling(original[e], original[e - 1]) : 0.0);
    }
  for (std::size_t k = 0; k < yarns.knots.size(); ++k)
    matrix.to_segment_before.push_back(
        yarns.before_knot[k] < 0 ? 0.0 : coupling(original[yarns.knots[k]], original[yarns.before_knot[k]]));
  return matrix;
}

/// Vectors in space are solved for axis by axis.
void expect_same_along_axes(const YarnFactor& factor, const std::vector<double>& b,
                            const std::vector<double>& x) {
  std::vector<Vec3> in_space;
  for (const double value : b) in_space.emplace_back(value, 0, -2 * value);
  factor.solve(std::span<const Vec3>(in_space), in_space);
  for (std::size_t e = 0; e < x.size(); ++e) EXPECT_EQ(in_space[e], Vec3(x[e], 0, -2 * x[e]));
}

/// Solves for b = sin(original number) on all ranks; the result in original order.
std::vector<double> solve_in_order(const DistributedMesh& mesh) {
  const Yarns yarns = find_yarns(mesh);
  YarnFactor factor(yarns);
  factor.factor(matrix_on(mesh, yarns));
  std::vector<double> b(mesh.edges.owned), x(mesh.edges.owned);
  for (Local e = 0; e < mesh.edges.owned; ++e) b[e] = std::sin(double(mesh.edges.original[e]));
  factor.solve(b, x);
  expect_same_along_axes(factor, b, x);
  return mesh.edge_order.to_slab<double>(x);
}

/// The same, dense: the matrix is assembled from the triples of the whole mesh.
Eigen::VectorXd solve_dense(const DistributedMesh& mesh) {
  const Local n = mesh.edges.owned;
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd b(n);
  std::map<std::pair<Local, Local>, Global> edge_of;
  for (Local e = 0; e < n; ++e) {
    const Global original = mesh.edges.original[e];
    a(original, original) = diagonal(original);
    b(original) = std::sin(double(original));
    const auto& [v, w] = mesh.edge_vertices[e];
    edge_of[{v, w}] = edge_of[{w, v}] = original;
  }
  for (const auto& [before, centre, after] : mesh.triples) {
    const Global e = edge_of.at({before, centre}), f = edge_of.at({centre, after});
    a(e, f) = a(f, e) = coupling(e, f);
  }
  return a.partialPivLu().solve(b);
}

void compare(const MeshSlab& slab, const MeshSlab& whole, const std::vector<int>& owners) {
  const Eigen::VectorXd dense =
      solve_dense(spread(MPI_COMM_SELF, whole, std::vector<int>(std::size_t(whole.vertices.total), 0)));
  const DistributedMesh mesh = spread(world, slab, owners);
  const auto x = solve_in_order(mesh);
  const Global first = mesh.edge_order.slab().first;
  // Condition numbers of these blocks are below 100: round-off stays far below 1e-12 of the largest entry.
  for (std::size_t i = 0; i < x.size(); ++i)
    EXPECT_NEAR(x[i], dense[first + Global(i)], 1e-12 * dense.cwiseAbs().maxCoeff());
}

} // namespace

TEST(Yarns, OfAGridAreItsRowsAndColumns) {
  const MeshSlab slab = make_grid(world, {1, 1}, {9, 6});
  for (unsigned seed = 0; seed < 4; ++seed) {
    const DistributedMesh mesh = spread(world, slab, random_owners(slab.vertices, seed));
    const Yarns yarns = find_yarns(mesh);
    EXPECT_EQ(yarns.count, 9 + 6);
    Global edges = 0;
    for (const YarnSegment& s : yarns.segments) edges += s.size();
    EXPECT_EQ(edges, mesh.edges.owned);
  }
}

TEST(Yarns, HaveTheSameNumberOnAllTheirEdges) {
  // The yarn of an edge is the lowest edge of its row or column, wherever the edge lives.
  const MeshSlab slab = make_grid(world, {1, 1}, {7, 5});
  const DistributedMesh mesh = spread(world, slab, random_owners(slab.vertices, 11));
  const Yarns yarns = find_yarns(mesh);
  for (const YarnSegment& s : yarns.segments)
    for (Local e = s.begin; e < s.end; ++e) {
      const Global v = mesh.vertices.original[mesh.edge_vertices[e][0]],
                   w = mesh.vertices.original[mesh.edge_vertices[e][1]];
      const bool along_row = w == v + 1;
      // Edges are numbered by their vertices: each vertex has first the edge along its row, then that along
      // its column, which makes 13 a row.
      const Global row = v / 7, column = v % 7;
      const Global expected = along_row ? 13 * row : (column == 6 ? 12 : 2 * column + 1);
      EXPECT_EQ(s.yarn, expected) << "edge " << v << "-" << w;
    }
}

TEST(Yarns, AreNumberedAlikeOnAnyPartition) {
  const auto number = [](MPI_Comm comm, const MeshSlab& grid, const std::vector<int>& owners) {
    const DistributedMesh mesh = spread(comm, grid, owners);
    const std::vector<Global> numbers = yarn_numbers(mesh, find_yarns(mesh));
    const auto of_edge = fetch<Global>(comm, mesh.edge_order.slab(), mesh.edge_order.to_slab<Global>(numbers),
                                       mesh.edges.original);
    EXPECT_EQ(numbers, of_edge); // ghosts know it too
    return mesh.edge_order.to_slab<Global>(numbers);
  };
  const MeshSlab slab = make_grid(world, {1, 1}, {7, 5}), whole = make_grid(MPI_COMM_SELF, {1, 1}, {7, 5});
  const auto expected = number(MPI_COMM_SELF, whole, std::vector<int>(35, 0));
  // The first row, its columns as its vertices come, then the other rows.
  EXPECT_THAT(std::span(expected).first(13), ElementsAre(0, 1, 0, 2, 0, 3, 0, 4, 0, 5, 0, 6, 7));
  EXPECT_EQ(*std::max_element(expected.begin(), expected.end()), 7 + 5 - 1);
  for (unsigned seed = 0; seed < 6; ++seed) {
    const auto here = number(world, slab, random_owners(slab.vertices, seed));
    const Global first = slab_of(Global(expected.size()), size_of(world), rank_of(world)).first;
    EXPECT_TRUE(std::equal(here.begin(), here.end(), expected.begin() + first)) << "seed " << seed;
  }
}

TEST(Yarns, ClosedOnesAreCutAtTheSamePlaceOnAnyPartition) {
  const auto solved = [](MPI_Comm comm, const std::vector<int>& owners) {
    const DistributedMesh mesh = spread(comm, tube_mesh(comm), owners);
    EXPECT_EQ(find_yarns(mesh).count, tube_around + tube_along);
    return solve_in_order(mesh);
  };
  const Slab slab = slab_of(tube_around * tube_along, size_of(world), rank_of(world));
  const auto expected = solved(MPI_COMM_SELF, std::vector<int>(tube_around * tube_along, 0));
  const Global first = slab_of(Global(expected.size()), size_of(world), rank_of(world)).first;
  const auto expect_same = [&](const std::vector<int>& owners) {
    const auto x = solved(world, owners);
    for (std::size_t i = 0; i < x.size(); ++i) EXPECT_NEAR(x[i], expected[first + Global(i)], 1e-12);
  };
  for (unsigned seed = 0; seed < 6; ++seed) expect_same(random_owners(slab, seed));
  for (Global shift = 0; shift < tube_around;
       ++shift) { // strips along the tube: each ring is cut into a few pieces
    std::vector<int> owners;
    for (Global v = slab.first; v < slab.first + slab.count; ++v)
      owners.push_back(int((v + shift) % tube_around * size_of(world) / tube_around));
    expect_same(owners);
  }
}

TEST(Yarns, ClosedOnesAreCutAtTheLowerVertexOfTheirLowestEdge) {
  const DistributedMesh mesh = spread(world, tube_mesh(world), random_owners(tube_mesh(world).vertices, 3));
  const Yarns yarns = find_yarns(mesh);
  for (const YarnSegment& s : yarns.segments)
    for (Local e = s.begin + 1; e < s.end; ++e)
      for (const Local shared : mesh.edge_vertices[e])
        if (const auto& [a, b] = mesh.edge_vertices[e - 1]; shared == a || shared == b) {
          const Global v = mesh.vertices.original[shared], w = mesh.vertices.original[a == shared ? b : a];
          const bool along_ring = v / tube_around == w / tube_around;
          EXPECT_FALSE(along_ring && v % tube_around == 0) << "no segment goes on through vertex " << v;
        }
}

TEST(YarnFactor, EqualsADenseSolveOnRandomPartitions) {
  const MeshSlab slab = make_grid(world, {1, 1}, {13, 8}), whole = make_grid(MPI_COMM_SELF, {1, 1}, {13, 8});
  for (unsigned seed = 0; seed < 8; ++seed) compare(slab, whole, random_owners(slab.vertices, seed));
}

TEST(YarnFactor, EqualsADenseSolveWithEmptyRanks) {
  const MeshSlab slab = make_grid(world, {1, 1}, {6, 7}), whole = make_grid(MPI_COMM_SELF, {1, 1}, {6, 7});
  compare(slab, whole, std::vector<int>(slab.vertices.count, size_of(world) - 1));
}

TEST(YarnFactor, EqualsADenseSolveOnAYarnThatChangesRanksAtEveryVertex) {
  const MeshSlab slab = make_line(world, 1, 40), whole = make_line(MPI_COMM_SELF, 1, 40);
  std::vector<int> owners;
  for (Global v = slab.vertices.first; v < slab.vertices.first + slab.vertices.count; ++v)
    owners.push_back(int(v % size_of(world)));
  compare(slab, whole, owners);
}

TEST(YarnFactor, EqualsADenseSolveOnMetisPartitions) {
  const MeshSlab slab = make_grid(world, {1, 1}, {17, 19}),
                 whole = make_grid(MPI_COMM_SELF, {1, 1}, {17, 19});
  compare(slab, whole, partition(world, slab, find_topology(world, slab), Partitioner::metis));
}
