#pragma once
#include "src/garment/sewing_pattern.hpp"

namespace taut::garment {

/// The pattern with its panels where they can be sewn from:
///
/// 1. Of two that are sewn together, and of which one is above the other with a gap between them, the gap is
///    closed in the mean along the seam (an arc hangs below its ends): a bodice that is placed apart from its
///    skirt would else be drawn down from the shoulders. The shifts s along y minimise the sum over seams, by
///    their lengths, of (gap + s_above - s_below)^2, and are the smallest that do. What is as high as each
///    other, as a hood and what it surrounds, stays.
/// 2. Those that are in each other's way are moved apart by `apart` (m), along the normal of the one and away
///    from the middle of the garment. That is so for panels in one plane that are nearer than that to each
///    other, as the backs of trousers at the crotch. Of two that are sewn together it is so where they lie on
///    each other, or where the outline of one touches the other elsewhere than at a seam that is closed. That
///    may be along a seam, too: where it is gathered, what belongs together is not at one place.
SewingPattern place_panels(SewingPattern pattern, double apart);

} // namespace taut::garment
