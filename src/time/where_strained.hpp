#pragma once
#include "src/constraints/strain_gauge.hpp"
#include "src/contact/obstacles.hpp"

namespace taut {

/// Where the cloth is strained most at `positions` (local vertices, ghosts current), in words: the place, and
/// how far from there the nearest obstacle is at `time`. Empty if a strain is not a number. Collective.
std::string where_strained(const Cloth& cloth, const StrainGauge& gauge, const Obstacles& obstacles,
                           std::span<const Vec3> positions, double time);

} // namespace taut
