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
/// 2. Those that lie in one plane, nearer to each other than `apart` (m), as the backs of trousers at the
///    crotch, are moved apart by as much, along the normal of the plane and away from the middle of the
///    garment.
SewingPattern place_panels(SewingPattern pattern, double apart);

} // namespace taut::garment
