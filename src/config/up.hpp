#pragma once
#include "partition/types.hpp"
#include "src/config/choices.hpp"

#include <span>

namespace taut::config {

/// Turns places in a file with this axis up so that z is up: x stays where it is.
inline void turn_upright(UpAxis up, std::span<Vec3> places) {
  if (up == UpAxis::z) return;
  for (Vec3& p : places) p = Vec3(p[0], -p[2], p[1]);
}

} // namespace taut::config
