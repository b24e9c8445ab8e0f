#pragma once
#include "partition/near_vertices.hpp"
#include "partition/topology.hpp"

namespace taut {

/// What is cut for the ranks: vertices of a slab, each with those that it has to do with, in its star or near
/// it, and its work.
struct PartitionGraph {
  std::vector<std::size_t> begin; ///< of slab vertex i: neighbours[begin[i] .. begin[i+1])
  std::vector<Global> neighbours; ///< original numbers, ascending
  std::vector<int> work;          ///< of slab vertices, relative; empty: all the same
};

/// Of a mesh alone. Not collective.
PartitionGraph graph_of(const Topology& topology);

/// Of a mesh and of what is near each other, which is in contact or will be: cloth that lies in layers is
/// then cut through all of them. What a vertex has near it beyond its star is work too. Not collective.
PartitionGraph graph_of(const Topology& topology, const NearVertices& near);

/// m, of the edges of a mesh at rest, on the mean; 0 if it has none. Collective.
double mean_edge(MPI_Comm comm, const MeshSlab& mesh, const Topology& topology);

} // namespace taut
