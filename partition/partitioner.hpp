#pragma once
#include "partition/partition_graph.hpp"

namespace taut {

enum class Partitioner {
  metis, ///< k-way over the vertex graph, computed on rank 0; the other ranks hold nothing but their own part
  ptscotch, ///< recursive bisection over the vertex graph in parallel: no rank holds the whole graph
  stripes,  ///< original order cut into equal pieces: no graph, for tests and for comparison
};

/// Whether the graph is looked at: there is nothing to cut for one part, and stripes need none.
bool needs_graph(const Slab& vertices, Partitioner method, int parts);

/// The part, of `parts`, that each vertex of this rank's slab belongs to. Parts may end up empty, e.g. when
/// there are more of them than vertices. Collective.
std::vector<int> partition(MPI_Comm comm, const Slab& vertices, const PartitionGraph& graph,
                           Partitioner method, int parts);

/// The same of a mesh alone.
inline std::vector<int> partition(MPI_Comm comm, const MeshSlab& mesh, const Topology& topology,
                                  Partitioner method, int parts) {
  const bool is_looked_at = needs_graph(mesh.vertices, method, parts);
  return partition(comm, mesh.vertices, is_looked_at ? graph_of(topology) : PartitionGraph{}, method, parts);
}

/// And with one part a rank: the owner of each vertex.
inline std::vector<int> partition(MPI_Comm comm, const MeshSlab& mesh, const Topology& topology,
                                  Partitioner method) {
  return partition(comm, mesh, topology, method, size_of(comm));
}

} // namespace taut
