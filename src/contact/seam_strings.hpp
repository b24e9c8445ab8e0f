#pragma once
#include "src/contact/obstacles.hpp"
#include "src/state/cloth.hpp"

namespace taut {

/// The straight ways between vertices that are to be sewn together, as far as they are clear of the full
/// bodies at the start: `string` elements of local vertices, each on the rank that owns the first of them.
/// Obstacles stop them as they stop edges, so that a sleeve closes around the arm that lies in it, and not
/// through it. A way through a body may lie on the wrong side of it when it is slim, and would stay open
/// there. `positions` of local vertices (m) at time 0. Not collective.
std::vector<Element> strings_clear_of(const Obstacles& obstacles, const Cloth& cloth,
                                      std::span<const Vec3> positions);

} // namespace taut
