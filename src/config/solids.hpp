#pragma once
#include "src/config/case.hpp"

#include <cmath>

/// How large the parts of a union are.
namespace taut::config {

/// From the middle of a solid to the nearest place of its surface, m.
inline double half_width(const Solid& s) {
  if (s.sphere) return s.sphere->radius;
  return s.capsule ? s.capsule->radius : 0.5 * (s.box->max - s.box->min).minCoeff();
}

/// The box around a solid.
inline Box around(const Solid& s) {
  if (s.box) return *s.box;
  const Vec3 a = s.sphere ? s.sphere->centre : s.capsule->from, b = s.sphere ? a : s.capsule->to;
  const Vec3 radius = Vec3::Constant(half_width(s));
  return {a.cwiseMin(b) - radius, a.cwiseMax(b) + radius};
}

/// The box around all parts.
inline Box around(const Union& u) {
  Box box{Vec3::Constant(HUGE_VAL), Vec3::Constant(-HUGE_VAL)};
  for (const Solid& s : u.parts) {
    const Box part = around(s);
    box = {box.min.cwiseMin(part.min), box.max.cwiseMax(part.max)};
  }
  return box;
}

} // namespace taut::config
