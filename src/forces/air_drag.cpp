#include "src/forces/air_drag.hpp"

#include <Eigen/Geometry>

#include <cmath>
#include <numbers>

namespace taut {

namespace {

/// Half the cross product of a quad's diagonals, of a triangle's sides: area times normal.
Vec3 area_vector(const LocalCell& cell, std::span<const Vec3> x) {
  const auto& v = cell.vertices;
  const Vec3 &a = x[v[0]], &c = x[v[2]];
  return cell.size() == 3 ? 0.5 * (x[v[1]] - a).cross(c - a) : 0.5 * (c - a).cross(x[v[3]] - x[v[1]]);
}

} // namespace

Vec3 AirDrag::wind_at(const Vec3& position, double time) const {
  const double speed = air_.wind.norm();
  if (speed == 0 || air_.gust.speed == 0) return air_.wind;
  const Vec3 along = air_.wind / speed;
  const double phase = position.dot(along) / air_.gust.length - time / air_.gust.period;
  return air_.wind + air_.gust.speed * std::sin(2 * std::numbers::pi * phase) * along;
}

void AirDrag::add_to(StepSystem& system, const State& state) {
  for (const LocalCell& cell : cloth_.mesh.cells) {
    const int n = cell.size();
    if (n == 2) continue;
    Vec3 velocity = Vec3::Zero(), centre = Vec3::Zero();
    for (int k = 0; k < n; ++k) {
      velocity += state.velocities[cell.vertices[k]] / n;
      centre += state.positions[cell.vertices[k]] / n;
    }
    const Vec3 area = area_vector(cell, state.positions);
    const double size = area.norm();
    if (size == 0) continue;
    const Vec3 normal = area / size, wind = wind_at(centre, state.time);
    const double d = 0.5 * air_.density * air_.drag * size * std::abs((velocity - wind).dot(normal));
    std::array<Local, 4> vertices = cell.vertices;
    std::array<Vec3, 4> gradient{normal / n, normal / n, normal / n,
                                 n == 4 ? Vec3(normal / n) : Vec3(Vec3::Zero())};
    if (n == 3) vertices[3] = vertices[0];
    for (int k = 0; k < n; ++k) system.add_force(vertices[k], d * wind.dot(normal) * gradient[k]);
    system.add_rank_one(vertices, gradient, 0.0, d);
  }
}

} // namespace taut
