#pragma once
#include "src/filters/velocity_filter.hpp"
#include "src/linear/pattern.hpp"

#include <memory>

namespace taut {

/// The filter of `inextensibility.method`; null if the method needs none. `cloth` and
/// `pattern` must outlive it. Collective.
std::unique_ptr<VelocityFilter> make_filter(const Cloth& cloth, const Pattern& pattern,
                                            const config::Inextensibility& options);

} // namespace taut
