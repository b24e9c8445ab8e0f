#pragma once
#include "partition/topology.hpp"

namespace taut {

/// A mesh in slabs, with what follows from its cells.
struct ListedMesh {
  MeshSlab slab;
  Topology topology;
};

/// All meshes as one: vertices, cells and constrained edges are numbered through all of them in their order,
/// and shared out in new slabs. Each keeps the topology it came with, so that a mesh of triangles alone keeps
/// its edges beside one of quads. No rank holds more than its slabs. Lines of files are not kept: the meshes
/// have been checked. Collective.
ListedMesh join(MPI_Comm comm, std::span<const ListedMesh> meshes);

} // namespace taut
