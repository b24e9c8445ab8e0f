#pragma once
#include "partition/topology.hpp"

namespace taut {

enum class Partitioner {
  metis, ///< k-way over the vertex graph, computed on rank 0; the other ranks hold nothing but their own part
  stripes, ///< original order cut into equal pieces: no graph, for tests and for comparison
};

/// The owner of each vertex of this rank's slab. Ranks may end up empty, e.g. when there are more ranks than
/// vertices. Collective.
std::vector<int> partition(MPI_Comm comm, const MeshSlab& mesh, const Topology& topology, Partitioner method);

} // namespace taut
