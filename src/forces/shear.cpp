#include "src/forces/shear.hpp"

#include "src/forces/stretch.hpp"
#include "src/state/material_coordinates.hpp"

#include <Eigen/Geometry>

#include <cmath>

namespace taut {

namespace {

std::array<Vec3, 4> corners(const std::array<Local, 4>& v, std::span<const Vec3> x) {
  return {x[v[0]], x[v[1]], x[v[2]], x[v[3]]};
}

std::array<Local, 4> corners_of(const LocalCell& cell) {
  auto v = cell.vertices;
  if (cell.size() == 3) v[3] = v[0];
  return v;
}

Vec3 weighted_sum(const std::array<double, 4>& c, const std::array<Vec3, 4>& x) {
  return c[0] * x[0] + c[1] * x[1] + c[2] * x[2] + c[3] * x[3];
}

} // namespace

ShearStencil quad_shear_stencil(const std::array<Vec3, 4>& rest) {
  const double u = 1.0 / ((rest[1] - rest[0]).norm() + (rest[2] - rest[3]).norm());
  const double v = 1.0 / ((rest[3] - rest[0]).norm() + (rest[2] - rest[1]).norm());
  ShearStencil s{{-u, u, u, -u}, {-v, -v, v, v}, 0.0};
  s.rest = weighted_sum(s.c_u, rest).dot(weighted_sum(s.c_v, rest));
  return s;
}

ShearStencil triangle_shear_stencil(const Corners2& m) {
  const auto [u, v] = tangent_coefficients(m);
  return {{u[0], u[1], u[2], 0.0}, {v[0], v[1], v[2], 0.0}, 0.0};
}

ShearValue evaluate(const ShearStencil& s, const std::array<Vec3, 4>& x) {
  const Vec3 w_u = weighted_sum(s.c_u, x), w_v = weighted_sum(s.c_v, x);
  ShearValue value{w_u.dot(w_v) - s.rest, {}};
  for (int k = 0; k < 4; ++k) value.gradient[k] = s.c_u[k] * w_v + s.c_v[k] * w_u;
  return value;
}

Shear::Shear(const Cloth& cloth, const Pattern& pattern, const PerSection<double>& stiffness,
             const PerPiece<double>& damping)
    : cloth_(cloth), stiffness_(stiffness), damping_(damping) {
  const DistributedMesh& mesh = cloth.mesh;
  elements_.reserve(mesh.cells.size());
  for (std::size_t c = 0; c < mesh.cells.size(); ++c)
    if (mesh.cells[c].size() > 2 && stiffness.of(cloth.section_of(mesh.cell_originals[c])))
      elements_.push_back({Local(c), pattern.slots<4>(corners_of(mesh.cells[c]))});
}

Shear::Face Shear::face(Local cell) const {
  const DistributedMesh& mesh = cloth_.mesh;
  const auto v = corners_of(mesh.cells[cell]);
  const auto p = corners_at_rest(mesh, std::size_t(cell));
  const bool quad = mesh.cells[cell].size() == 4;
  const double area = 0.5 * (p[2] - p[0]).cross(p[quad ? 3 : 2] - p[1]).norm();
  const double stiffness = *stiffness_.of(cloth_.section_of(mesh.cell_originals[std::size_t(cell)]));
  return {
      v, quad ? quad_shear_stencil(p) : triangle_shear_stencil(material_coordinates(mesh, std::size_t(cell))),
      stiffness * area, damping_.of(cloth_.piece_of(v[0])).value_or(0)};
}

double Shear::energy(const State& state) const {
  double energy = 0;
  for (const Element& element : elements_) {
    if (!cloth_.mesh.owns_vertex(cloth_.mesh.cells[element.cell].vertices[0])) continue;
    const Face f = face(element.cell);
    const double c = evaluate(f.stencil, corners(f.vertices, state.positions)).condition;
    energy += 0.5 * f.stiffness * c * c;
  }
  return energy;
}

void Shear::add_to(StepSystem& system, const State& state) {
  for (const Element& element : elements_) {
    const Face f = face(element.cell);
    const auto [c, gradient] = evaluate(f.stencil, corners(f.vertices, state.positions));
    double rate = 0;
    for (int k = 0; k < 4; ++k) {
      system.add_force(f.vertices[k], -f.stiffness * c * gradient[k]);
      rate += gradient[k].dot(state.velocities[f.vertices[k]]);
    }
    system.add_rank_one(f.vertices, gradient, f.stiffness, f.stiffness * f.damping);
    // t (c_u c_v^T + c_v c_u^T) = t/2 (s s^T - d d^T), s = c_u + c_v, d = c_u - c_v
    const double t = f.stiffness * (c + f.damping * rate);
    std::array<double, 4> half;
    for (int k = 0; k < 4; ++k) half[k] = f.stencil.c_u[k] + (t > 0 ? f.stencil.c_v[k] : -f.stencil.c_v[k]);
    system.add_outer<4>(f.vertices, element.slots, half, 0.5 * std::abs(t), 0.0);
  }
}

} // namespace taut
