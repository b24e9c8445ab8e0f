#pragma once
#include "partition/types.hpp"

#include <numbers>

/// Angles and areas of the plane.
namespace taut::garment {

inline constexpr double degree = std::numbers::pi / 180; ///< rad

/// Twice the area of the triangle of two edges, positive where `b` lies to the left of `a`.
inline double cross(const Vec2& a, const Vec2& b) { return a[0] * b[1] - a[1] * b[0]; }

} // namespace taut::garment
