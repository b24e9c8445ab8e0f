#include "partition/mesh_slab.hpp"

#include "partition/comm.hpp"

#include <algorithm>

namespace taut {

Slab slab_of(Global total, int ranks, int rank) {
  const Global each = total / ranks, more = total % ranks;
  return {rank * each + std::min<Global>(rank, more), each + (rank < more ? 1 : 0), total};
}

int slab_rank(Global total, int ranks, Global i) {
  const Global each = total / ranks, more = total % ranks;
  const Global in_larger = more * (each + 1);
  if (i < in_larger) return int(i / (each + 1));
  return int(more + (i - in_larger) / each);
}

MeshSlab slab_of_whole(MPI_Comm comm, const std::vector<Vec3>& points, const std::vector<Cell>& cells) {
  MeshSlab mesh;
  mesh.vertices = slab_of(Global(points.size()), size_of(comm), rank_of(comm));
  mesh.cells = slab_of(Global(cells.size()), size_of(comm), rank_of(comm));
  const auto point = points.begin() + mesh.vertices.first;
  const auto cell = cells.begin() + mesh.cells.first;
  mesh.rest_positions.assign(point, point + mesh.vertices.count);
  mesh.cell.assign(cell, cell + mesh.cells.count);
  return mesh;
}

} // namespace taut
