#pragma once
#include "partition/types.hpp"

#include <vector>

namespace taut::config {

struct GravityKeyframe {
  double time = 0;                ///< s
  Vec3 value = Vec3(0, 0, -9.81); ///< m/s^2
  bool operator==(const GravityKeyframe&) const = default;
};

/// The acceleration of free fall: linear between keyframes, constant before and after.
struct Gravity {
  std::vector<GravityKeyframe> keyframes{1}; ///< at least one; times increase strictly

  Gravity() = default;
  Gravity(const Vec3& constant) : keyframes{{0, constant}} {} // NOLINT: a vector is one
  Vec3 at(double time) const;                                 ///< m/s^2
  double largest() const;                                     ///< m/s^2: it is never stronger
  bool operator==(const Gravity&) const = default;
};

} // namespace taut::config
