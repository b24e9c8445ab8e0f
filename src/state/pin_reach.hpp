#pragma once
#include "src/config/case.hpp"
#include "src/state/cloth.hpp"

namespace taut {

/// A vertex that a pin holds in all directions, as all ranks know it.
struct HeldVertex {
  std::size_t pin;
  Global vertex; ///< original number
  Vec3 start;    ///< m
};

/// Throws InputError where pins draw two of these vertices farther apart than the shortest way along the
/// edges of the cloth between them, each at its limit of strain: no step could follow. Told at the keyframe
/// at which it first is so. `held` is the same on all ranks. Collective.
void check_reach(const Cloth& cloth, const Case& input, std::span<const HeldVertex> held);

} // namespace taut
