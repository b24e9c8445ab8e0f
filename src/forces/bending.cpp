#include "src/forces/bending.hpp"

#include <algorithm>
#include <set>
#include <utility>

namespace taut {

namespace {

Vec3 weighted_sum(const std::array<Local, 3>& v, const std::array<double, 3>& w, std::span<const Vec3> x) {
  return w[0] * x[v[0]] + w[1] * x[v[1]] + w[2] * x[v[2]];
}

/// The sides of all faces, lower local number first.
std::set<std::pair<Local, Local>> sides_of_faces(const DistributedMesh& mesh) {
  std::set<std::pair<Local, Local>> sides;
  for (const LocalCell& c : mesh.cells)
    for (int k = 0; k < c.size() && c.size() > 2; ++k)
      sides.insert(std::minmax({c.vertices[k], c.vertices[(k + 1) % c.size()]}));
  return sides;
}

} // namespace

std::array<double, 3> curvature_weights(double l1, double l2) {
  const double scale = 2.0 / (l1 + l2);
  return {scale / l1, -scale / l1 - scale / l2, scale / l2};
}

YarnBending::YarnBending(const Cloth& cloth, const Pattern& pattern, Threads threads,
                         const PerPiece<double>& stiffness, const PerPiece<double>& damping)
    : name_(threads == Threads::all ? "bending" : "line_bending"), cloth_(cloth), stiffness_(stiffness),
      damping_(damping) {
  const DistributedMesh& mesh = cloth.mesh;
  const auto sides = threads == Threads::lines ? sides_of_faces(mesh) : std::set<std::pair<Local, Local>>();
  stencils_.reserve(mesh.triples.size());
  for (std::size_t k = 0; k < mesh.triples.size(); ++k) {
    const auto& t = mesh.triples[k];
    if (!stiffness.of(cloth.piece_of(t[1]))) continue;
    // Yarns and chains of lines never join, so one edge, of a cell this rank knows, tells for both.
    if (sides.contains(std::minmax({t[0], t[1]})) || sides.contains(std::minmax({t[1], t[2]}))) continue;
    stencils_.push_back({Local(k), pattern.slots<3>(t)});
  }
}

std::array<double, 3> YarnBending::weights_of(const std::array<Local, 3>& t) const {
  const auto length = [&](Local other) { return cloth_.rest_length[edge_between(cloth_.mesh, t[1], other)]; };
  auto weights = curvature_weights(length(t[0]), length(t[2]));
  const double scale = std::sqrt(*stiffness_.of(cloth_.piece_of(t[1])) * cloth_.measure[t[1]]);
  for (double& w : weights) w *= scale;
  return weights;
}

double YarnBending::energy(const State& state) const {
  double energy = 0;
  for (const Stencil& s : stencils_) {
    const auto& t = cloth_.mesh.triples[s.triple];
    if (cloth_.mesh.owns_vertex(t[1]))
      energy += 0.5 * weighted_sum(t, weights_of(t), state.positions).squaredNorm();
  }
  return energy;
}

void YarnBending::add_to(StepSystem& system, const State& state) {
  for (const Stencil& s : stencils_) {
    const auto& t = cloth_.mesh.triples[s.triple];
    const auto weights = weights_of(t);
    const Vec3 sum = weighted_sum(t, weights, state.positions);
    for (int k = 0; k < 3; ++k) system.add_force(t[k], -weights[k] * sum);
    system.add_outer<3>(t, s.slots, weights, 1.0, damping_.of(cloth_.piece_of(t[1])).value_or(0));
  }
}

} // namespace taut
