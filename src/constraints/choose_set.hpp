#pragma once
#include "src/constraints/mixed_set.hpp"

namespace taut {

/// What `make`, a template over a set of constraints, makes for the one that a case and its mesh ask for.
template<class Make>
auto for_chosen_set(const Cloth& cloth, const config::Inextensibility& options, Make&& make) {
  if (options.constrain != config::Constrain::vertices) return make.template operator()<EdgeSet>();
  if (cloth.mesh.triangles_only) return make.template operator()<MetricSet>();
  return make.template operator()<MixedSet>();
}

} // namespace taut
