#include "src/newton/triangle_penalty.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace taut {

namespace {

constexpr double part_of_bound = 0.5; // from which on it acts
constexpr double stiff = 100;         // see README.md

std::vector<Tangent> local_tangents(const Cloth& cloth) {
  std::vector<Local> cells(cloth.mesh.cells.size());
  std::iota(cells.begin(), cells.end(), 0);
  return bounded_tangents(cloth, cells);
}

} // namespace

TrianglePenalty::TrianglePenalty(const Cloth& cloth, const config::Inextensibility& options)
    : free_(part_of_bound * options.faces * options.strain) {
  for (const Tangent& t : local_tangents(cloth)) directions_.push_back({t.stencil, std::sqrt(t.measure)});
}

void TrianglePenalty::begin(std::span<const double> metric) {
  held_.clear();
  for (Direction& d : directions_) {
    double yields = 0;
    for (int k = 0; k < 3; ++k) yields += metric[d.stencil.vertices[k]] * d.stencil.c[k] * d.stencil.c[k];
    d.stiffness = yields > 0 ? stiff / (yields * d.scale * d.scale) : 0.0;
  }
}

TrianglePenalty::Answer TrianglePenalty::answer(const Direction& d, std::span<const Vec3> x) const {
  const Vec3 w = tangent(d.stencil, x);
  const double length = w.norm(), beyond = std::abs(length - 1) - free_;
  if (!(beyond > 0) || length == 0) return {Vec3::Zero(), 0, 0};
  const double pull = d.stiffness * d.scale * std::copysign(beyond, length - 1);
  return {w / length, pull, std::clamp(pull / (d.scale * length), 0.0, d.stiffness)};
}

void TrianglePenalty::evaluate(std::span<const Vec3> x, std::span<const Vec3> v, double dt,
                               std::span<Vec3> residual) const {
  for (const Direction& d : directions_) {
    const auto [direction, pull, across] = answer(d, x);
    if (pull == 0) continue;
    for (int k = 0; k < 3; ++k)
      residual[d.stencil.vertices[k]] -= d.scale * d.stencil.c[k] * pull * direction;
  }
  for (const auto& [vertices, gradient] : held_) {
    double sum = 0;
    for (int k = 0; k < 3; ++k) sum += dt * gradient[k].dot(v[vertices[k]]);
    for (int k = 0; k < 3; ++k) residual[vertices[k]] += sum * gradient[k];
  }
}

std::vector<VertexMatrix::RankOne> TrianglePenalty::terms(std::span<const Vec3> x) {
  held_.clear();
  const auto hold = [&](const Direction& d, const Vec3& along) {
    const auto& [v, c] = d.stencil;
    held_.push_back({{v[0], v[1], v[2], v[0]}, {c[0] * along, c[1] * along, c[2] * along, Vec3::Zero()}});
  };
  for (const Direction& d : directions_) {
    const auto [direction, pull, across] = answer(d, x);
    if (pull == 0) continue;
    hold(d, d.scale * std::sqrt(d.stiffness) * direction);
    if (across == 0) continue;
    const Vec3 first = d.scale * std::sqrt(across) * direction.unitOrthogonal();
    hold(d, first);
    hold(d, direction.cross(first));
  }
  return held_;
}

} // namespace taut
