#include "src/forces/angle_bending.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace taut {

AngleBending::AngleBending(const Cloth& cloth, Folds folds, RestAngle rest, PerPiece<double> damping)
    : cloth_(cloth), folds_(std::move(folds)), damping_(std::move(damping)) {
  for (const HingeStencil& f : folds_.hinges)
    rest_angles_.push_back(rest == RestAngle::flat ? 0.0 : dihedral(f.rest).angle);
}

Dihedral AngleBending::bend_of(std::size_t fold, const State& state) const {
  Dihedral bend = dihedral(folds_.hinges[fold].corners(state.positions));
  bend.angle -= rest_angles_[fold];
  return bend;
}

double AngleBending::energy(const State& state) const {
  std::vector<double> angle(folds_.hinges.size());
  double energy = 0;
  for (std::size_t k = 0; k < angle.size(); ++k) {
    const HingeStencil& f = folds_.hinges[k];
    angle[k] = bend_of(k, state).angle;
    if (cloth_.mesh.owns_vertex(f.vertices[0])) energy += 0.5 * f.stiffness * angle[k] * angle[k];
  }
  for (const TriangleStencil& t : folds_.triangles) {
    if (!cloth_.mesh.owns_vertex(t.vertices[0])) continue;
    for (const auto& row : t.rows) {
      double sum = 0;
      for (std::size_t k = 0; k < 3 && t.folds[k] >= 0; ++k)
        sum += weight(t, row, k) * angle[std::size_t(t.folds[k])];
      energy += 0.5 * sum * sum;
    }
  }
  return energy;
}

void AngleBending::add_hinge(const HingeStencil& fold, const Dihedral& bend, StepSystem& system) const {
  const auto& v = fold.vertices;
  const auto gradient = spread(fold, bend.gradient);
  const double moment = fold.stiffness * bend.angle, damping = damping_at(v[0]) * fold.stiffness;
  for (int k = 0; k < 6; ++k) system.add_force(v[k], -moment * gradient[k]);
  if (fold.size() == 4)
    system.add_rank_one(std::array<Local, 4>{v[0], v[1], v[2], v[4]}, bend.gradient, fold.stiffness, damping);
  else
    system.add_rank_one(v, gradient, fold.stiffness, damping);
}

void AngleBending::add_triangle(const TriangleStencil& t, const std::vector<Dihedral>& bends,
                                StepSystem& system) const {
  for (const auto& row : t.rows) {
    double moment = 0;
    std::array<Vec3, 6> gradient;
    gradient.fill(Vec3::Zero());
    for (std::size_t k = 0; k < 3 && t.folds[k] >= 0; ++k) {
      const Dihedral& bend = bends[std::size_t(t.folds[k])];
      const double w = weight(t, row, k);
      moment += w * bend.angle;
      for (std::size_t c = 0; c < 4; ++c) gradient[std::size_t(t.place[k][c])] += w * bend.gradient[c];
    }
    for (std::size_t k = 0; k < 6; ++k) system.add_force(t.vertices[k], -moment * gradient[k]);
    system.add_rank_one(t.vertices, gradient, 1.0, damping_at(t.vertices[0]));
  }
}

void AngleBending::add_to(StepSystem& system, const State& state) {
  std::vector<Dihedral> bends;
  bends.reserve(folds_.hinges.size());
  for (std::size_t k = 0; k < folds_.hinges.size(); ++k) {
    bends.push_back(bend_of(k, state));
    if (folds_.hinges[k].stiffness > 0) add_hinge(folds_.hinges[k], bends[k], system);
  }
  for (const TriangleStencil& t : folds_.triangles) add_triangle(t, bends, system);
}

double largest_rest_angle(const Cloth& cloth, const Folds& folds) {
  double largest = 0;
  for (const HingeStencil& f : folds.hinges) largest = std::max(largest, std::abs(dihedral(f.rest).angle));
  return max_over(cloth.mesh.comm, largest);
}

} // namespace taut
