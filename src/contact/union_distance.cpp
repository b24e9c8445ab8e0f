#include "src/contact/union_distance.hpp"

#include <algorithm>
#include <cmath>

namespace taut {

namespace {

using Value = UnionDistance::Value;

Value from_point(const Vec3& x, const Vec3& centre, double radius) {
  const Vec3 away = x - centre;
  const double far = away.norm();
  return {far - radius, far > 0 ? Vec3(away / far) : Vec3(Vec3::UnitZ())};
}

Value from_capsule(const Vec3& x, const config::Capsule& c) {
  const Vec3 axis = c.to - c.from;
  const double size = axis.squaredNorm();
  const double along = size > 0 ? std::clamp(axis.dot(x - c.from) / size, 0.0, 1.0) : 0.0;
  return from_point(x, c.from + along * axis, c.radius);
}

Value from_box(const Vec3& x, const config::Box& box) {
  const Vec3 middle = x - 0.5 * (box.min + box.max);
  const Vec3 beyond = middle.cwiseAbs() - 0.5 * (box.max - box.min); // the sides, along each axis
  const Vec3 sign = middle.unaryExpr([](double s) { return std::copysign(1.0, s); });
  const Vec3 out = beyond.cwiseMax(0.0);
  if (const double far = out.norm(); far > 0) return {far, out.cwiseProduct(sign) / far};
  int axis = 0;
  const double inside = beyond.maxCoeff(&axis);
  return {inside, sign[axis] * Vec3::Unit(axis)};
}

Value from_solid(const Vec3& x, const config::Solid& s) {
  if (s.sphere) return from_point(x, s.sphere->centre, s.sphere->radius);
  return s.capsule ? from_capsule(x, *s.capsule) : from_box(x, *s.box);
}

} // namespace

Value UnionDistance::at(const Vec3& x) const {
  const double r = input_.blend;
  Value nearest{HUGE_VAL, Vec3::Zero()};
  double squares = 0;
  Vec3 sum = Vec3::Zero();
  for (const config::Solid& part : input_.parts) {
    const Value here = from_solid(x, part);
    if (here.distance < nearest.distance) nearest = here;
    const double u = std::max(r - here.distance, 0.0);
    squares += u * u;
    sum += u * here.gradient;
  }
  if (squares == 0) return nearest;
  const double u = std::sqrt(squares);
  return {r - u, sum / u};
}

bool UnionDistance::may_be_near(const Vec3& x, double radius) const {
  double nearest = HUGE_VAL;
  for (const config::Solid& part : input_.parts) nearest = std::min(nearest, from_solid(x, part).distance);
  const double blended = input_.blend * (1 - 1 / std::sqrt(double(input_.parts.size())));
  return nearest >= -radius && nearest <= blended + radius;
}

} // namespace taut
