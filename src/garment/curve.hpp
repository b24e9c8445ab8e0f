#pragma once
#include "partition/types.hpp"

#include <array>
#include <optional>
#include <span>
#include <variant>
#include <vector>

/// Curves of the plane, in m.
namespace taut::garment {

/// A cubic Bézier curve; straight lines and quadratic ones are such too.
struct Bezier {
  std::array<Vec2, 4> control; ///< first and last: its ends
};

/// A part of a circle.
struct Arc {
  std::array<Vec2, 2> ends;
  Vec2 centre;
  double radius = 0;
  double from = 0; ///< rad, of the start
  double turn = 0; ///< rad from start to end, positive counter-clockwise
};

using Curve = std::variant<Bezier, Arc>;

Curve line(const Vec2& start, const Vec2& end);
Curve quadratic(const Vec2& start, const Vec2& control, const Vec2& end);

enum class Turn { clockwise, counter_clockwise };
enum class ArcSize { small, large }; ///< up to a half turn, or from there on

/// The arc of this radius; nothing if the ends are farther apart than the circle is wide.
std::optional<Curve> arc(const Vec2& start, const Vec2& end, double radius, ArcSize size, Turn turn);

const Vec2& start_of(const Curve& curve);
const Vec2& end_of(const Curve& curve);

double length_of(const Curve& curve);

/// The area, in m^2, that the line from the origin to a point sweeps while the point follows the curve;
/// positive counter-clockwise. Over a closed outline the sum is the area inside.
double swept_area(const Curve& curve);

/// The points at these parts of the length, ascending from 0 to 1. Those at 0 and 1 are the ends to the last
/// bit.
std::vector<Vec2> points_along(const Curve& curve, std::span<const double> parts);

} // namespace taut::garment
