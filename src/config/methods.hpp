#pragma once
#include "src/config/case.hpp"

/// What the methods of `inextensibility` have in common.
namespace taut::config {

/// It solves linear systems, up to `max_iterations` of them a step.
constexpr bool is_projection(InextensibilityMethod m) {
  using enum InextensibilityMethod;
  return m == fast_projection || m == icd || m == sap || m == shake || m == rattle;
}

/// It sweeps over the edges.
constexpr bool is_limiting(InextensibilityMethod m) {
  return m == InextensibilityMethod::jacobi || m == InextensibilityMethod::gauss_seidel;
}

/// It changes the candidate of a step, and so knows the tension that the next one can start from.
constexpr bool is_filter(InextensibilityMethod m) { return is_projection(m) || is_limiting(m); }

/// No step is accepted whose strain is over the limit. Otherwise the strain is what it comes to be, and is
/// reported.
inline bool holds_limit(const Inextensibility& i) {
  return is_projection(i.method) ||
         (is_limiting(i.method) && i.limiting.value_or(Limiting{}).must_reach_limit);
}

/// What the strain limit holds for, on a mesh of triangles alone or on another.
inline Constrain constrain_of(const Case& input, bool triangles_only) {
  const bool can_average =
      input.inextensibility.method == InextensibilityMethod::fast_projection && !input.has_contact();
  return input.inextensibility.constrain.value_or(triangles_only && can_average ? Constrain::vertices
                                                                                : Constrain::edges);
}

} // namespace taut::config
