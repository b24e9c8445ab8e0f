#include "src/state/material_coordinates.hpp"

#include <Eigen/Geometry>

namespace taut {

namespace {

/// dx/du of a triangle with the texture `t`, of any length; zero where that has no area.
Vec3 textured_warp(const std::array<Vec3, 4>& x, const Corners2& t) {
  const Vec2 one = t[1] - t[0], two = t[2] - t[0];
  const double area = one[0] * two[1] - two[0] * one[1];
  if (!(std::abs(area) > 1e-12 * one.norm() * two.norm())) return Vec3::Zero();
  return ((x[1] - x[0]) * two[1] - (x[2] - x[0]) * one[1]) / area;
}

Vec3 warp_of_quad(const std::array<Vec3, 4>& x, int side) {
  return side == 0 ? x[1] - x[0] + x[2] - x[3] : x[3] - x[0] + x[2] - x[1];
}

} // namespace

Vec3 default_warp(const Vec3& normal) {
  constexpr double nearly_parallel = 1e-3;
  const Vec3 n = normal.normalized();
  for (const Vec3& axis : {Vec3(Vec3::UnitX()), Vec3(Vec3::UnitY())}) {
    const Vec3 in_plane = axis - n * n.dot(axis);
    if (in_plane.norm() > nearly_parallel) return in_plane.normalized();
  }
  return Vec3::UnitY(); // not reached: one of two axes is far from any normal
}

int warp_side(const DistributedMesh& mesh, std::size_t cell) {
  if (mesh.texture.empty()) return 0;
  const Corners2& t = mesh.texture[cell];
  const Vec2 run = t[1] - t[0] + t[2] - t[3];
  return std::abs(run[0]) >= std::abs(run[1]) ? 0 : 1;
}

Corners2 material_coordinates(const DistributedMesh& mesh, std::size_t cell) {
  const LocalCell& c = mesh.cells[cell];
  const Corners2* texture = mesh.texture.empty() ? nullptr : &mesh.texture[cell];
  const std::array<Vec3, 4> x = corners_at_rest(mesh, cell);
  const bool quad = c.size() == 4;
  const Vec3 normal = quad ? (x[2] - x[0]).cross(x[3] - x[1]) : (x[1] - x[0]).cross(x[2] - x[0]);
  Vec3 warp = quad      ? warp_of_quad(x, warp_side(mesh, cell))
              : texture ? textured_warp(x, *texture)
                        : Vec3(Vec3::Zero());
  if (warp.isZero(0)) warp = default_warp(normal);
  const Vec3 n = normal.normalized(), u = (warp - n * n.dot(warp)).normalized(), v = n.cross(u);
  Corners2 corners;
  for (int k = 0; k < c.size(); ++k) corners[k] = {u.dot(x[k] - x[0]), v.dot(x[k] - x[0])};
  for (int k = c.size(); k < 4; ++k) corners[k].setZero();
  return corners;
}

} // namespace taut
