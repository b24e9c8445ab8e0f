#include "src/forces/stretch.hpp"

#include "src/state/material_coordinates.hpp"

#include <algorithm>
#include <cmath>

namespace taut {

namespace {

double double_area(const Vec2& a, const Vec2& b) { return a[0] * b[1] - b[0] * a[1]; }

void append_triangle(const DistributedMesh& mesh, std::size_t cell, std::vector<Tangent>& tangents) {
  const auto& v = mesh.cells[cell].vertices;
  const Corners2 m = material_coordinates(mesh, cell);
  const auto c = tangent_coefficients(m);
  const double area = 0.5 * double_area(m[1] - m[0], m[2] - m[0]);
  for (int direction = 0; direction < 2; ++direction)
    tangents.push_back({{{v[0], v[1], v[2]}, c[direction]}, area, direction, cell});
}

void append_side(Local a, Local b, double length, double measure, int direction, std::size_t cell,
                 std::vector<Tangent>& tangents) {
  tangents.push_back({{{a, b, a}, {-1 / length, 1 / length, 0}}, measure, direction, cell});
}

/// A quad need not be plane: its sides are as long as they are in space.
void append_quad(const DistributedMesh& mesh, std::size_t cell, std::vector<Tangent>& tangents) {
  const auto& v = mesh.cells[cell].vertices;
  const auto rest = corners_at_rest(mesh, cell);
  const Corners2 m = material_coordinates(mesh, cell);
  const double area = 0.5 * double_area(m[2] - m[0], m[3] - m[1]);
  const int first = warp_side(mesh, cell); // direction of side 0
  for (int k = 0; k < 4; ++k) {
    const int next = (k + 1) % 4;
    append_side(v[k], v[next], (rest[next] - rest[k]).norm(), area / 2, (first + k) % 2, cell, tangents);
  }
}

} // namespace

std::array<std::array<double, 3>, 2> tangent_coefficients(const Corners2& m) {
  const Vec2 one = m[1] - m[0], two = m[2] - m[0];
  const double d = double_area(one, two);
  return {
      {{(one[1] - two[1]) / d, two[1] / d, -one[1] / d}, {(two[0] - one[0]) / d, -two[0] / d, one[0] / d}}};
}

void append_tangents(const Cloth& cloth, std::size_t cell, std::vector<Tangent>& tangents) {
  const DistributedMesh& mesh = cloth.mesh;
  if (mesh.cells[cell].size() == 2) {
    const auto& v = mesh.cells[cell].vertices;
    const double length = (mesh.rest_positions[v[1]] - mesh.rest_positions[v[0]]).norm();
    append_side(v[0], v[1], length, length, 0, cell, tangents);
  } else {
    mesh.cells[cell].size() == 3 ? append_triangle(mesh, cell, tangents) : append_quad(mesh, cell, tangents);
  }
}

std::vector<Tangent> tangents_of(const Cloth& cloth) {
  std::vector<Tangent> tangents;
  for (std::size_t c = 0; c < cloth.mesh.cells.size(); ++c) append_tangents(cloth, c, tangents);
  return tangents;
}

double largest_strain(const Cloth& cloth, std::span<const Tangent> tangents,
                      std::span<const Vec3> positions) {
  double largest = 0;
  for (const Tangent& t : tangents) {
    const double strain = std::abs(tangent(t.stencil, positions).norm() - 1.0);
    largest = std::max(largest, std::isfinite(strain) ? strain : HUGE_VAL);
  }
  return max_over(cloth.mesh.comm, largest);
}

double largest_stretch_change(const Cloth& cloth, std::span<const Tangent> tangents,
                              std::span<const Vec3> from, std::span<const Vec3> to) {
  double largest = 0;
  for (const Tangent& t : tangents) {
    const double change = std::abs(tangent(t.stencil, to).norm() - tangent(t.stencil, from).norm());
    largest = std::max(largest, std::isfinite(change) ? change : HUGE_VAL);
  }
  return max_over(cloth.mesh.comm, largest);
}

Stretch::Stretch(const Cloth& cloth, const Pattern& pattern, const PerSection<StretchMaterial>& material)
    : cloth_(cloth) {
  for (const Tangent& t : tangents_of(cloth))
    if (const auto& m = material.of(cloth.section_of(cloth.mesh.cell_originals[t.cell])))
      elements_.push_back({t.stencil, m->stiffness[t.direction] * t.measure, m->target[t.direction],
                           m->damping, m->compression, pattern.slots<3>(t.stencil.vertices)});
}

double Stretch::energy(const State& state) const {
  double energy = 0;
  for (const Element& e : elements_) {
    if (!cloth_.mesh.owns_vertex(e.tangent.vertices[0])) continue;
    const double length = tangent(e.tangent, state.positions).norm(), stretch = length - e.target;
    energy += 0.5 * e.stiffness_at(length) * stretch * stretch;
  }
  return energy;
}

void Stretch::add_to(StepSystem& system, const State& state) {
  for (const Element& e : elements_) {
    const auto& v = e.tangent.vertices;
    const auto& c = e.tangent.c;
    const Vec3 w = tangent(e.tangent, state.positions);
    const double length = w.norm();
    if (length == 0) continue; // without a direction: nowhere to push
    const Vec3 direction = w / length;
    const double stiffness = e.stiffness_at(length), tension = stiffness * (length - e.target),
                 drag = e.damping * stiffness * direction.dot(tangent(e.tangent, state.velocities));
    for (int k = 0; k < 3; ++k) system.add_force(v[k], -tension * c[k] * direction);
    // k n n^T + across (I - n n^T), n the direction, as across I + (k - across) n n^T.
    const double across = std::clamp((tension + drag) / length, 0.0, stiffness);
    system.add_outer<3>(e.tangent.vertices, e.slots, c, across, 0.0);
    system.add_rank_one(std::array<Local, 4>{v[0], v[1], v[2], v[0]},
                        {c[0] * direction, c[1] * direction, c[2] * direction, Vec3::Zero()},
                        stiffness - across, e.damping * stiffness);
  }
}

} // namespace taut
