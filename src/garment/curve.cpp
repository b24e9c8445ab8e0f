#include "src/garment/curve.hpp"

#include "src/garment/plane.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace taut::garment {

namespace {

Vec2 point_at(const Bezier& b, double t) {
  const double s = 1 - t;
  return s * s * s * b.control[0] + 3 * s * s * t * b.control[1] + 3 * s * t * t * b.control[2] +
         t * t * t * b.control[3];
}

Vec2 velocity_at(const Bezier& b, double t) {
  const double s = 1 - t;
  return 3 * (s * s * (b.control[1] - b.control[0]) + 2 * s * t * (b.control[2] - b.control[1]) +
              t * t * (b.control[3] - b.control[2]));
}

/// Gauss-Legendre on [-1, 1], exact to degree 9.
constexpr std::array<double, 5> nodes{-0.9061798459386640, -0.5384693101056831, 0, 0.5384693101056831,
                                      0.9061798459386640};
constexpr std::array<double, 5> weights{0.2369268850561891, 0.4786286704993665, 0.5688888888888889,
                                        0.4786286704993665, 0.2369268850561891};

template<class Function>
double integrate(double from, double to, Function&& function) {
  double sum = 0;
  for (std::size_t i = 0; i < nodes.size(); ++i)
    sum += weights[i] * function((from + to) / 2 + (to - from) / 2 * nodes[i]);
  return sum * (to - from) / 2;
}

/// The length of a Bézier curve up to a parameter, and the parameter of a length. A control point far off
/// makes a sharp bend, for which the curve is cut into many pieces.
class ArcLength {
public:
  explicit ArcLength(const Bezier& curve) : curve_(curve) {
    for (int i = 0; i < pieces; ++i)
      until_[i + 1] = until_[i] + length(double(i) / pieces, double(i + 1) / pieces);
  }

  double total() const { return until_[pieces]; }

  double parameter(double wanted) const {
    const auto above = std::upper_bound(until_.begin(), until_.end() - 1, wanted);
    const int piece = std::max(0, int(above - until_.begin()) - 1);
    const double begin = double(piece) / pieces;
    double low = begin, high = double(piece + 1) / pieces;
    const double whole = until_[piece + 1] - until_[piece];
    double t = whole > 0 ? low + (high - low) * (wanted - until_[piece]) / whole : low;
    for (int i = 0; i < 60; ++i) { // Newton, kept between bounds
      const double error = until_[piece] + length(begin, t) - wanted;
      (error > 0 ? high : low) = t;
      const double step = error / velocity_at(curve_, t).norm();
      if (!(std::abs(error) > 1e-14 * total())) break;
      t = t - step > low && t - step < high ? t - step : (low + high) / 2;
    }
    return t;
  }

private:
  static constexpr int pieces = 64;

  double length(double from, double to) const {
    return integrate(from, to, [&](double t) { return velocity_at(curve_, t).norm(); });
  }

  const Bezier& curve_;
  std::array<double, pieces + 1> until_{};
};

Vec2 point_at(const Arc& a, double part) {
  const double angle = a.from + part * a.turn;
  return a.centre + a.radius * Vec2(std::cos(angle), std::sin(angle));
}

} // namespace

Curve line(const Vec2& start, const Vec2& end) {
  return Bezier{{start, start + (end - start) / 3, end - (end - start) / 3, end}};
}

Curve quadratic(const Vec2& start, const Vec2& control, const Vec2& end) {
  return Bezier{{start, (start + 2 * control) / 3, (end + 2 * control) / 3, end}};
}

std::optional<Curve> arc(const Vec2& start, const Vec2& end, double radius, ArcSize size, Turn turn) {
  const Vec2 chord = end - start, left(-chord[1], chord[0]);
  const double half = chord.norm() / 2;
  if (!(radius >= half * (1 - 1e-6))) return std::nullopt; // a half circle may have been rounded
  Arc arc{{start, end}, {}, std::max(radius, half), 0, 0};
  const double rise = std::sqrt(std::max(0.0, arc.radius * arc.radius - half * half));
  const bool centre_left = (turn == Turn::counter_clockwise) == (size == ArcSize::small);
  arc.centre = (start + end) / 2 + (centre_left ? rise : -rise) * left / left.norm();
  const Vec2 a = start - arc.centre;
  arc.from = std::atan2(a[1], a[0]);
  const double small = 2 * std::atan2(half, rise);
  const double angle = size == ArcSize::small ? small : 2 * std::numbers::pi - small;
  arc.turn = turn == Turn::counter_clockwise ? angle : -angle;
  return arc;
}

const Vec2& start_of(const Curve& curve) {
  if (const Bezier* b = std::get_if<Bezier>(&curve)) return b->control.front();
  return std::get<Arc>(curve).ends[0];
}

const Vec2& end_of(const Curve& curve) {
  if (const Bezier* b = std::get_if<Bezier>(&curve)) return b->control.back();
  return std::get<Arc>(curve).ends[1];
}

double length_of(const Curve& curve) {
  if (const Bezier* b = std::get_if<Bezier>(&curve)) return ArcLength(*b).total();
  const Arc& a = std::get<Arc>(curve);
  return a.radius * std::abs(a.turn);
}

double swept_area(const Curve& curve) {
  if (const Bezier* b = std::get_if<Bezier>(&curve)) // a polynomial of degree 5
    return integrate(0, 1, [&](double t) { return cross(point_at(*b, t), velocity_at(*b, t)) / 2; });
  const Arc& a = std::get<Arc>(curve);
  return (a.radius * a.radius * a.turn + cross(a.centre, a.ends[1] - a.ends[0])) / 2;
}

std::vector<Vec2> points_along(const Curve& curve, std::span<const double> parts) {
  std::vector<Vec2> points;
  const Bezier* bezier = std::get_if<Bezier>(&curve);
  const auto lengths = bezier ? std::optional<ArcLength>(*bezier) : std::nullopt;
  for (const double part : parts) {
    if (part <= 0)
      points.push_back(start_of(curve));
    else if (part >= 1)
      points.push_back(end_of(curve));
    else
      points.push_back(bezier ? point_at(*bezier, lengths->parameter(part * lengths->total()))
                              : point_at(std::get<Arc>(curve), part));
  }
  return points;
}

} // namespace taut::garment
