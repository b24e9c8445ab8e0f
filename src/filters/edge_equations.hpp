#pragma once
#include "partition/distributed_mesh.hpp"
#include "src/state/freedom.hpp"

namespace taut {

/// The edges' part of a quadratic program: see ProjectionSystem::assemble.
struct EdgeEquations {
  std::span<const Vec3> gradient;       ///< of local edges
  std::span<const double> inverse_mass; ///< of local vertices
  const Freedom& freedom;               ///< of local vertices
  std::span<const double> shift;        ///< of owned edges
  std::span<const double> residual;     ///< C - a mu of owned edges, what their rows have to take away
  std::span<const double> tolerance;    ///< of owned edges, what may be left of it
  std::span<const double> guess;        ///< of owned edges, the multipliers' increments
};

/// J' mu, the sum of what all edges pull at a vertex; `mu` of local edges.
inline Vec3 pull_at(const DistributedMesh& mesh, const EdgeEquations& edges, std::span<const double> mu,
                    Local vertex) {
  Vec3 pull = Vec3::Zero();
  for (const EdgeEnd& end : mesh.star_of(vertex)) pull += end.sign * mu[end.edge] * edges.gradient[end.edge];
  return pull;
}

} // namespace taut
