#pragma once
#include "partition/partition_graph.hpp"

namespace taut {

/// The part of each vertex of this rank's slab, by PT-Scotch's parallel multilevel bisection of the graph:
/// each rank gives the neighbours of its slab, and only graphs that are coarse enough are ever joined.
/// Throws InputError if the graph is too large for the integers of the library, or if it refuses.
/// Collective.
std::vector<int> ptscotch_parts(MPI_Comm comm, const Slab& vertices, const PartitionGraph& graph, int parts);

} // namespace taut
