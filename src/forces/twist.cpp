#include "src/forces/twist.hpp"

#include <Eigen/Geometry>

#include <cmath>

namespace taut {

namespace {

double area_of(const std::array<Vec3, 4>& quad) {
  return 0.5 * (quad[2] - quad[0]).cross(quad[3] - quad[1]).norm();
}

} // namespace

std::array<double, 4> twist_weights(const std::array<Vec3, 4>& x) {
  const Vec3 normal = (x[2] - x[0]).cross(x[3] - x[1]); // as long as two areas
  const double l_u = (x[1] - x[0]).norm() + (x[2] - x[3]).norm(),
               l_v = (x[3] - x[0]).norm() + (x[2] - x[1]).norm(); // twice the means
  const double areas = normal.squaredNorm();
  if (!(areas > 0)) return {};
  const auto without = [&](int a, int b, int c) { // over the mean of all four
    return 2 * (x[b] - x[a]).cross(x[c] - x[a]).dot(normal) / areas;
  };
  const double scale = 4 / (l_u * l_v);
  return {scale * without(1, 2, 3), -scale * without(0, 2, 3), scale * without(0, 1, 3),
          -scale * without(0, 1, 2)};
}

Twist::Twist(const Cloth& cloth, const Pattern& pattern, const PerSection<double>& stiffness,
             const PerPiece<double>& damping)
    : cloth_(cloth), damping_(damping) {
  const DistributedMesh& mesh = cloth.mesh;
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
    const auto& v = mesh.cells[c].vertices;
    const auto& t = stiffness.of(cloth.section_of(mesh.cell_originals[c]));
    if (mesh.cells[c].size() != 4 || !t) continue;
    const auto rest = corners_at_rest(mesh, c);
    auto weights = twist_weights(rest);
    for (double& w : weights) w *= std::sqrt(2 * *t * area_of(rest));
    stencils_.push_back({v, weights, pattern.slots<4>(v)});
  }
}

double Twist::energy(const State& state) const {
  double energy = 0;
  for (const Stencil& s : stencils_)
    if (cloth_.mesh.owns_vertex(s.vertices[0])) energy += 0.5 * s.sum(state.positions).squaredNorm();
  return energy;
}

void Twist::add_to(StepSystem& system, const State& state) {
  for (const Stencil& s : stencils_) {
    const Vec3 sum = s.sum(state.positions);
    for (int k = 0; k < 4; ++k) system.add_force(s.vertices[k], -s.weights[k] * sum);
    system.add_outer<4>(s.vertices, s.slots, s.weights, 1.0,
                        damping_.of(cloth_.piece_of(s.vertices[0])).value_or(0));
  }
}

} // namespace taut
