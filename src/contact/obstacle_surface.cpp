#include "src/contact/obstacle_surface.hpp"

#include <Eigen/Geometry>

#include <numbers>

namespace taut {

namespace {

constexpr int meridians = 48, rings = 24;

} // namespace

ObstacleSurface::ObstacleSurface(const Obstacles& obstacles, double plane_size) : obstacles_(obstacles) {
  const auto start = obstacles.start();
  for (const Element& e : obstacles.elements()) {
    const auto& v = e.vertices;
    if (e.is_triangle()) {
      const Global a = add_vertex(start[v[0]], e.body, v[0]), b = add_vertex(start[v[1]], e.body, v[1]);
      add_face(a, b, add_vertex(start[v[2]], e.body, v[2]));
    } else {
      add_round(start[v[0]], start[v[e.corners - 1]], obstacles.body(e.body).radius, e.body);
    }
  }
  for (const Obstacles::Plane& plane : obstacles.planes()) add_plane(plane, start[plane.point], plane_size);
}

std::vector<Vec3> ObstacleSurface::at(double time) const {
  std::vector<Vec3> positions, corners;
  obstacles_.place(time, corners);
  for (std::size_t v = 0; v < start_.size(); ++v)
    positions.push_back(vertex_of_[v] >= 0 ? corners[vertex_of_[v]]
                                           : obstacles_.moved(body_of_[v], start_[v], time));
  return positions;
}

void ObstacleSurface::add_round(const Vec3& a, const Vec3& b, double radius, int body) {
  const Vec3 axis = (b - a).norm() > 0 ? Vec3((b - a).normalized()) : Vec3(Vec3::UnitZ());
  const Vec3 x = axis.unitOrthogonal(), y = axis.cross(x);
  const Global first = Global(start_.size());
  for (int r = 0; r <= rings; ++r) // from the pole at a to that at b, the middle ring twice
    for (const Vec3& centre :
         r<rings / 2 ? std::vector{a} : r> rings / 2 ? std::vector{b} : std::vector{a, b})
      for (int m = 0; m < meridians; ++m) {
        const double polar = std::numbers::pi * r / rings, around = 2 * std::numbers::pi * m / meridians;
        add_vertex(centre + radius * (-std::cos(polar) * axis +
                                      std::sin(polar) * (std::cos(around) * x + std::sin(around) * y)),
                   body);
      }
  for (int r = 0; r <= rings; ++r)
    for (int m = 0; m < meridians; ++m) {
      const Global here = first + r * meridians + m, next = first + r * meridians + (m + 1) % meridians;
      add_face(here, next, next + meridians);
      add_face(here, next + meridians, here + meridians);
    }
}

void ObstacleSurface::add_plane(const Obstacles::Plane& plane, const Vec3& point, double size) {
  const Vec3 x = 0.5 * size * plane.normal.unitOrthogonal(), y = plane.normal.cross(x);
  const Vec3 middle = point + obstacles_.body(plane.body).radius * plane.normal;
  const Global a = add_vertex(middle - x - y, plane.body), b = add_vertex(middle + x - y, plane.body);
  const Global c = add_vertex(middle + x + y, plane.body), d = add_vertex(middle - x + y, plane.body);
  add_face(a, b, c);
  add_face(a, c, d);
}

Global ObstacleSurface::add_vertex(const Vec3& x, int body, Local vertex) {
  start_.push_back(x);
  vertex_of_.push_back(vertex);
  body_of_.push_back(body);
  return Global(start_.size()) - 1;
}

void ObstacleSurface::add_face(Global a, Global b, Global c) {
  faces_.push_back({a, b, c});
  bodies_.push_back(body_of_[a]);
}

} // namespace taut
