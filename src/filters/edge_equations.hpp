#pragma once
#include "src/state/freedom.hpp"

namespace taut {

/// The edges' part of a quadratic program: see ProjectionSystem::assemble.
struct EdgeEquations {
  std::span<const Vec3> gradient;            ///< of local edges
  std::span<const double> inverse_mass;      ///< of local vertices
  const Freedom& freedom;                    ///< of local vertices
  std::span<const double> scaled_compliance; ///< of owned edges
  std::span<const double> residual;          ///< C - a mu of owned edges, what their rows have to take away
  std::span<const double> tolerance;         ///< of owned edges, what may be left of it
  std::span<const double> guess;             ///< of owned edges, the multipliers' increments
};

} // namespace taut
