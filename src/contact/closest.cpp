#include "src/contact/closest.hpp"

#include <Eigen/Geometry>

#include <algorithm>

namespace taut {

namespace {

/// Barycentric coordinates of the point of the triangle (a, b, c) closest to p, by the Voronoi region p is
/// in.
Vec3 closest_in_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return {1, 0, 0};
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return {0, 1, 0};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) {
    const double v = d1 / (d1 - d3);
    return {1 - v, v, 0};
  }
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return {0, 0, 1};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) {
    const double w = d2 / (d2 - d6);
    return {1 - w, 0, w};
  }
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    const double w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return {0, 1 - w, w};
  }
  const double scale = 1.0 / (va + vb + vc), v = vb * scale, w = vc * scale;
  return {1 - v - w, v, w};
}

double clamped(double value) { return std::clamp(value, 0.0, 1.0); }

} // namespace

Closest closest_vertex_face(const Four& x) {
  const Vec3 b = closest_in_triangle(x[0], x[1], x[2], x[3]);
  const Vec3 offset = x[0] - b[0] * x[1] - b[1] * x[2] - b[2] * x[3];
  return {{1.0, -b[0], -b[1], -b[2]}, offset, offset.norm()};
}

Closest closest_edge_edge(const Four& x) {
  const Vec3 d1 = x[1] - x[0], d2 = x[3] - x[2], r = x[0] - x[2];
  const double a = d1.squaredNorm(), e = d2.squaredNorm(), f = d2.dot(r), c = d1.dot(r);
  double s = 0, t = 0;
  if (a > 0 && e > 0) {
    const double b = d1.dot(d2), denominator = a * e - b * b;
    s = denominator > 0 ? clamped((b * f - c * e) / denominator) : 0.0;
    t = (b * s + f) / e;
    if (t < 0)
      t = 0, s = clamped(-c / a);
    else if (t > 1)
      t = 1, s = clamped((b - c) / a);
  } else if (a > 0) {
    s = clamped(-c / a);
  } else if (e > 0) {
    t = clamped(f / e);
  }
  const Vec3 offset = r + s * d1 - t * d2;
  return {{1 - s, s, t - 1, -t}, offset, offset.norm()};
}

bool passes(const Vec3& from, const Vec3& to, const std::array<Vec3, 3>& t) {
  const Vec3 along = to - from, u = t[1] - t[0], v = t[2] - t[0], p = along.cross(v);
  const double volume = u.dot(p);
  if (volume == 0) return false;
  const Vec3 s = from - t[0], q = s.cross(u);
  const double a = s.dot(p) / volume, b = along.dot(q) / volume, way = v.dot(q) / volume;
  return a >= 0 && b >= 0 && a + b <= 1 && way >= 0 && way <= 1;
}

} // namespace taut
