#pragma once
#include "partition/distributed_mesh.hpp"

namespace taut {

/// The constrained edges in groups of which no two share a vertex, so that all of a group can be changed at
/// once.
struct EdgeColours {
  /// For each colour the local edges with at least one end that this rank owns. As many colours on all ranks.
  std::vector<std::vector<Local>> edges;
};

/// Each edge takes the lowest colour that none of its neighbours has which come before it in an order drawn
/// by lot from the original numbers [Jones, Plassmann 1993]: the same for any partition. Some rounds of the
/// halo. Collective.
EdgeColours colour_edges(const DistributedMesh& mesh);

} // namespace taut
