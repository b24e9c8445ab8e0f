#pragma once
#include "src/constraints/bounded_set.hpp"

#include <type_traits>

namespace taut {

/// What `make`, a template over a set of constraints, makes for the one that a case and its mesh ask for of
/// a projection.
template<class Make>
auto for_chosen_set(const Cloth& cloth, const config::Inextensibility& options, Make&& make) {
  if (options.constrain != config::Constrain::vertices) return make.template operator()<EdgeSet>();
  if (cloth.mesh.triangles_only) return make.template operator()<BoundedSet<MetricSet>>();
  return make.template operator()<BoundedSet<MixedSet>>();
}

/// The same in Newton's method.
template<class Make>
auto for_chosen_set_in_newton(const Cloth& cloth, const config::Inextensibility& options, Make&& make) {
  if (options.constrain != config::Constrain::vertices) return make.template operator()<EdgeSet>();
  if (cloth.mesh.triangles_only) return make.template operator()<MetricSet>();
  return make.template operator()<MixedSet>();
}

/// The set by which what Newton's method leaves is corrected: `Set`, with bounds for single triangles.
template<class Set>
using Bounded = std::conditional_t<std::is_same_v<Set, EdgeSet>, EdgeSet, BoundedSet<Set>>;

} // namespace taut
