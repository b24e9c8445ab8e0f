#pragma once
#include "src/contact/obstacles.hpp"
#include "src/state/cloth.hpp"

namespace taut::command {

/// How far up each cloth is to be moved (m; negative: down) so that no seam is drawn together across a body.
/// What counts is how many straight ways between vertices that belong together pass through a body, at the
/// place and, less, up to 10 cm above and below. Of the places up to 20 cm away, with none on the way that is
/// worse than the start, the nearest at which these are hardly more than the fewest. So a shirt is lifted
/// until its shoulders pass over those of the body, and trousers come to where their crotch passes between
/// the legs. `positions` and `obstacles` as they start. Collective.
std::vector<double> lifts_of(const Cloth& cloth, std::span<const Vec3> positions, const Obstacles& obstacles);

} // namespace taut::command
