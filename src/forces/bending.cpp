#include "src/forces/bending.hpp"

namespace taut {

namespace {

Vec3 weighted_sum(const std::array<Local, 3>& v, const std::array<double, 3>& w, std::span<const Vec3> x) {
  return w[0] * x[v[0]] + w[1] * x[v[1]] + w[2] * x[v[2]];
}

} // namespace

std::array<double, 3> curvature_weights(double l1, double l2) {
  const double scale = 2.0 / (l1 + l2);
  return {scale / l1, -scale / l1 - scale / l2, scale / l2};
}

YarnBending::YarnBending(const Cloth& cloth, const Pattern& pattern, double stiffness, double damping)
    : cloth_(cloth), damping_(damping) {
  const DistributedMesh& mesh = cloth.mesh;
  const auto& rest = mesh.rest_positions;
  stencils_.reserve(mesh.triples.size());
  for (const auto& t : mesh.triples) {
    auto weights = curvature_weights((rest[t[1]] - rest[t[0]]).norm(), (rest[t[2]] - rest[t[1]]).norm());
    for (double& w : weights) w *= std::sqrt(stiffness * cloth.measure[t[1]]);
    stencils_.push_back({t, weights, pattern.slots<3>(t)});
  }
}

double YarnBending::energy(const State& state) const {
  double energy = 0;
  for (const Stencil& s : stencils_)
    if (cloth_.mesh.owns_vertex(s.vertices[1]))
      energy += 0.5 * weighted_sum(s.vertices, s.weights, state.positions).squaredNorm();
  return energy;
}

void YarnBending::add_to(StepSystem& system, const State& state) const {
  for (const Stencil& s : stencils_) {
    const Vec3 sum = weighted_sum(s.vertices, s.weights, state.positions);
    for (int k = 0; k < 3; ++k) system.add_force(s.vertices[k], -s.weights[k] * sum);
    system.add_outer<3>(s.slots, s.weights, 1.0, damping_);
  }
}

} // namespace taut
