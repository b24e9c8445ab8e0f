#pragma once
#include "src/config/case.hpp"

/// What the methods of `inextensibility` have in common.
namespace taut::config {

/// It solves linear systems, up to `max_iterations` of them a step.
constexpr bool is_projection(InextensibilityMethod m) {
  using enum InextensibilityMethod;
  return m == fast_projection || m == newton || m == icd || m == sap || m == shake || m == rattle;
}

/// It sweeps over the edges.
constexpr bool is_limiting(InextensibilityMethod m) {
  return m == InextensibilityMethod::jacobi || m == InextensibilityMethod::gauss_seidel;
}

/// It changes the candidate of a step, and so knows the tension that the next one can start from.
constexpr bool is_filter(InextensibilityMethod m) {
  return (is_projection(m) && m != InextensibilityMethod::newton) || is_limiting(m);
}

/// It takes averages of the metric around vertices as well as the lengths of edges.
constexpr bool can_average(InextensibilityMethod m) {
  return m == InextensibilityMethod::fast_projection || m == InextensibilityMethod::newton;
}

/// Whether Newton's method has what the case asks of contact.
inline bool newton_knows_contact(const Case& input) {
  return !input.has_contact() || input.contact_model() == ContactModel::constraint;
}

/// Contact changes velocities after whatever keeps the strain.
inline bool contact_is_last(const Case& input) {
  if (input.contact_model() != ContactModel::impulse) return false;
  return input.contact->impulse.value_or(Impulse{}).order == FilterOrder::contact_last;
}

/// No step is accepted whose strain is over the limit. Otherwise the strain is what it comes to be, and is
/// reported.
inline bool holds_limit(const Case& input) {
  const Inextensibility& i = input.inextensibility;
  const bool keeps =
      is_projection(i.method) || (is_limiting(i.method) && i.limiting.value_or(Limiting{}).must_reach_limit);
  return keeps && !contact_is_last(input);
}

/// What the strain limit holds for, on meshes with triangles or without.
inline Constrain constrain_of(const Case& input, bool has_triangles) {
  const bool averages = can_average(input.inextensibility.method);
  return input.inextensibility.constrain.value_or(has_triangles && averages ? Constrain::vertices
                                                                            : Constrain::edges);
}

} // namespace taut::config
