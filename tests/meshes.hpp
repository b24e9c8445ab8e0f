#pragma once
// Meshes and partitions that tests of all layers share.
#include "partition/mesh_slab.hpp"

#include <cmath>
#include <random>

namespace taut::test {

inline const MPI_Comm world = MPI_COMM_WORLD;
inline const MPI_Comm self = MPI_COMM_SELF;

/// An owner for each vertex of this rank's slab, drawn at random.
inline std::vector<int> random_owners(const Slab& slab, unsigned seed) {
  std::vector<int> owners;
  std::mt19937 random(seed);
  for (Global i = 0; i < slab.total; ++i) {
    const int owner = int(random() % unsigned(size_of(world)));
    if (slab.contains(i)) owners.push_back(owner);
  }
  return owners;
}

constexpr Global tube_around = 8, tube_along = 4; // vertices

/// A tube whose rings are closed yarns; they begin with vertex i * tube_around.
inline MeshSlab tube_mesh(MPI_Comm comm) {
  std::vector<Vec3> points;
  std::vector<Cell> cells;
  for (Global v = 0; v < tube_around * tube_along; ++v) {
    const double angle = 2 * M_PI * double(v % tube_around) / tube_around;
    points.emplace_back(std::cos(angle), std::sin(angle), double(v / tube_around));
  }
  for (Global c = 0; c < tube_around * (tube_along - 1); ++c) {
    const Global i = c / tube_around, j = c % tube_around, k = (j + 1) % tube_around;
    cells.push_back(
        {{i * tube_around + j, i * tube_around + k, (i + 1) * tube_around + k, (i + 1) * tube_around + j}});
  }
  return slab_of_whole(comm, points, cells);
}

} // namespace taut::test
