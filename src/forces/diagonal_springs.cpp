#include "src/forces/diagonal_springs.hpp"

#include "src/state/material_coordinates.hpp"

#include <Eigen/Geometry>

#include <algorithm>

namespace taut {

DiagonalSprings::DiagonalSprings(const Cloth& cloth, const Pattern& pattern,
                                 const PerSection<double>& stiffness, const PerPiece<double>& damping)
    : cloth_(cloth) {
  for (std::size_t c = 0; c < cloth.mesh.cells.size(); ++c) {
    const LocalCell& cell = cloth.mesh.cells[c];
    const auto& v = cell.vertices;
    const auto& k_shear = stiffness.of(cloth.section_of(cloth.mesh.cell_originals[c]));
    if (cell.size() != 4 || !k_shear) continue;
    const std::array<Vec3, 4> rest = corners_at_rest(cloth.mesh, c);
    const double area = 0.5 * (rest[2] - rest[0]).cross(rest[3] - rest[1]).norm();
    for (const int k : {0, 1}) {
      const std::array<Local, 2> ends{v[k], v[k + 2]};
      const double length = (rest[k + 2] - rest[k]).norm();
      springs_.push_back({ends, length, *k_shear * length * length / (2 * area),
                          damping.of(cloth.piece_of(v[0])).value_or(0), pattern.slots<2>(ends)});
    }
  }
}

double DiagonalSprings::energy(const State& state) const {
  double energy = 0;
  for (const Spring& s : springs_) {
    if (!cloth_.mesh.owns_vertex(s.vertices[0])) continue;
    const double stretch =
        (state.positions[s.vertices[1]] - state.positions[s.vertices[0]]).norm() - s.length;
    energy += 0.5 * s.stiffness * stretch * stretch;
  }
  return energy;
}

void DiagonalSprings::add_to(StepSystem& system, const State& state) {
  for (const Spring& s : springs_) {
    const auto& [a, b] = s.vertices;
    const Vec3 d = state.positions[b] - state.positions[a];
    const double length = d.norm();
    if (length == 0) continue; // without a direction: nowhere to push
    const Vec3 n = d / length;
    const double tension = s.stiffness * (length - s.length),
                 drag = s.damping * s.stiffness * n.dot(state.velocities[b] - state.velocities[a]);
    system.add_force(a, tension * n);
    system.add_force(b, -tension * n);
    const double across = std::clamp((tension + drag) / length, 0.0, s.stiffness);
    system.add_outer<2>(s.vertices, s.slots, {-1, 1}, across, 0.0);
    system.add_rank_one(std::array<Local, 4>{a, b, a, a}, {-n, n, Vec3::Zero(), Vec3::Zero()},
                        s.stiffness - across, s.damping * s.stiffness);
  }
}

} // namespace taut
