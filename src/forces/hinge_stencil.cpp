#include "src/forces/hinge_stencil.hpp"

#include "src/state/material_coordinates.hpp"

#include <Eigen/Geometry>

#include <cmath>

namespace taut {

namespace {

/// The direction of the edge along warp and weft.
Vec2 run_of(const Hinge& hinge, const std::array<Vec3, 4>& rest) {
  if (hinge.run != Vec2::Zero()) return hinge.run.normalized();
  const Vec3 e = (rest[1] - rest[0]).normalized();
  const Vec3 sum = e.cross(rest[2] - rest[0]).normalized() + (rest[3] - rest[0]).cross(e).normalized();
  const Vec3 normal = sum.isZero(1e-9) ? Vec3(Vec3::UnitZ()) : sum.normalized(), warp = default_warp(normal);
  const double u = e.dot(warp);
  return {u, std::copysign(std::sqrt(std::max(1 - u * u, 0.0)), e.dot(normal.cross(warp)))};
}

std::array<Vec3, 4> unfolded(const UnfoldedFaces& faces) {
  return {Vec3::Zero(), Vec3(faces.length, 0, 0), Vec3(faces.left[0], faces.left[1], 0),
          Vec3(faces.right[0], -faces.right[1], 0)};
}

/// Of the angle at `apex` of the triangle with the sides to `a` and `b`.
double cotangent(const Vec3& apex, const Vec3& a, const Vec3& b) {
  const Vec3 to_a = a - apex, to_b = b - apex;
  return to_a.dot(to_b) / to_a.cross(to_b).norm();
}

} // namespace

Dihedral dihedral(const std::array<Vec3, 4>& x) {
  const Vec3 e = x[1] - x[0], n1 = e.cross(x[2] - x[0]), n2 = (x[3] - x[0]).cross(e);
  const double l = e.norm(), s1 = n1.squaredNorm(), s2 = n2.squaredNorm();
  const double smallest = 1e-24 * l * l * l * l; // of a triangle that has collapsed onto its side
  if (!(s1 > smallest) || !(s2 > smallest))
    return {0.0, {Vec3::Zero(), Vec3::Zero(), Vec3::Zero(), Vec3::Zero()}};
  const Vec3 p1 = n1 / s1, p2 = n2 / s2;
  Dihedral d{std::atan2(n1.cross(n2).dot(e) / l, n1.dot(n2)), {}};
  d.gradient[0] = -((x[2] - x[1]).dot(e) / l) * p1 - ((x[3] - x[1]).dot(e) / l) * p2;
  d.gradient[1] = ((x[2] - x[0]).dot(e) / l) * p1 + ((x[3] - x[0]).dot(e) / l) * p2;
  d.gradient[2] = -l * p1;
  d.gradient[3] = -l * p2;
  return d;
}

std::array<Vec3, 4> HingeStencil::corners(std::span<const Vec3> x) const {
  const auto& v = vertices;
  return {x[v[0]], x[v[1]], weight[2] * x[v[2]] + weight[3] * x[v[3]],
          weight[4] * x[v[4]] + weight[5] * x[v[5]]};
}

double HingeStencil::area_of_side(int side) const {
  return 0.5 * (rest[1] - rest[0]).cross(rest[2 + side] - rest[0]).norm();
}

HingeStencil hinge_stencil(const DistributedMesh& mesh, const Hinge& h) {
  HingeStencil f{vertices_of(h), {1, 1, 1, 0, 1, 0}, {}, {}, 0, 0};
  if (h.left[1] >= 0) f.weight[2] = f.weight[3] = 0.5;
  if (h.right[1] >= 0) f.weight[4] = f.weight[5] = 0.5;
  f.rest = h.at_rest.length > 0 ? unfolded(h.at_rest) : f.corners(mesh.rest_positions);
  f.run = run_of(h, f.rest);
  f.area = f.area_of_side(0) + f.area_of_side(1);
  return f;
}

std::array<double, 4> isometric_row(const std::array<Vec3, 4>& rest) {
  const double c01 = cotangent(rest[0], rest[1], rest[2]), c02 = cotangent(rest[0], rest[1], rest[3]),
               c03 = cotangent(rest[1], rest[0], rest[2]), c04 = cotangent(rest[1], rest[0], rest[3]);
  return {c03 + c04, c01 + c02, -c01 - c03, -c02 - c04};
}

} // namespace taut
