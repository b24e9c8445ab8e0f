#pragma once
// Meshes and partitions that tests of all layers share.
#include "partition/mesh_slab.hpp"

#include <random>

namespace taut::test {

inline const MPI_Comm world = MPI_COMM_WORLD;
inline const MPI_Comm self = MPI_COMM_SELF;

/// A mesh of which every rank knows everything.
inline MeshSlab slab_of_whole(MPI_Comm comm, const std::vector<Vec3>& points,
                              const std::vector<Cell>& cells) {
  MeshSlab mesh;
  mesh.vertices = slab_of(Global(points.size()), size_of(comm), rank_of(comm));
  mesh.cells = slab_of(Global(cells.size()), size_of(comm), rank_of(comm));
  const auto point = points.begin() + mesh.vertices.first;
  const auto cell = cells.begin() + mesh.cells.first;
  mesh.rest_positions.assign(point, point + mesh.vertices.count);
  mesh.cell.assign(cell, cell + mesh.cells.count);
  return mesh;
}

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

} // namespace taut::test
