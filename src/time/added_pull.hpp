#pragma once
#include "src/state/cloth.hpp"
#include "src/state/state.hpp"

namespace taut {

/// N, on an owned vertex: what edges pull in the candidate beyond the tension `before`, N/m of local edges.
inline Vec3 added_pull(const DistributedMesh& mesh, Local vertex, std::span<const double> before,
                       const Candidate& candidate) {
  Vec3 pull = Vec3::Zero();
  for (const EdgeEnd& end : mesh.star_of(vertex))
    pull += (candidate.multipliers.force_density[end.edge] - before[end.edge]) *
            (candidate.positions[end.other] - candidate.positions[vertex]);
  return pull;
}

} // namespace taut
