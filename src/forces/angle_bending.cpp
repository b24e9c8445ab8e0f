#include "src/forces/angle_bending.hpp"

#include <algorithm>
#include <cmath>

namespace taut {

AngleBending::AngleBending(const Cloth& cloth, std::span<const HingeStencil> folds, RestAngle rest,
                           const PerPiece<double>& damping)
    : cloth_(cloth) {
  for (const HingeStencil& f : folds)
    bends_.push_back({f, rest == RestAngle::flat ? 0.0 : dihedral(f.rest).angle,
                      damping.of(cloth.piece_of(f.vertices[0])).value_or(0)});
}

double AngleBending::energy(const State& state) const {
  double energy = 0;
  for (const Bend& b : bends_) {
    if (!cloth_.mesh.owns_vertex(b.fold.vertices[0])) continue;
    const double angle = dihedral(b.fold.corners(state.positions)).angle - b.rest_angle;
    energy += 0.5 * b.fold.stiffness * angle * angle;
  }
  return energy;
}

void AngleBending::add_to(StepSystem& system, const State& state) {
  for (const auto& [fold, rest_angle, rate] : bends_) {
    const auto& v = fold.vertices;
    const auto [angle, corner_gradient] = dihedral(fold.corners(state.positions));
    const auto gradient = spread(fold, corner_gradient);
    const double moment = fold.stiffness * (angle - rest_angle), damping = rate * fold.stiffness;
    for (int k = 0; k < 6; ++k) system.add_force(v[k], -moment * gradient[k]);
    if (fold.size() == 4)
      system.add_rank_one(std::array<Local, 4>{v[0], v[1], v[2], v[4]}, corner_gradient, fold.stiffness,
                          damping);
    else
      system.add_rank_one(v, gradient, fold.stiffness, damping);
  }
}

double largest_rest_angle(const Cloth& cloth, std::span<const HingeStencil> folds) {
  double largest = 0;
  for (const HingeStencil& f : folds) largest = std::max(largest, std::abs(dihedral(f.rest).angle));
  return max_over(cloth.mesh.comm, largest);
}

} // namespace taut
