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
    : name_(threads == Threads::all ? "bending" : "line_bending"), cloth_(cloth) {
  const DistributedMesh& mesh = cloth.mesh;
  const auto sides = threads == Threads::lines ? sides_of_faces(mesh) : std::set<std::pair<Local, Local>>();
  const auto& rest = mesh.rest_positions;
  stencils_.reserve(mesh.triples.size());
  for (const auto& t : mesh.triples) {
    const std::size_t piece = cloth.piece_of(t[1]);
    if (!stiffness.of(piece)) continue;
    // Yarns and chains of lines never join, so one edge, of a cell this rank knows, tells for both.
    if (sides.contains(std::minmax({t[0], t[1]})) || sides.contains(std::minmax({t[1], t[2]}))) continue;
    auto weights = curvature_weights((rest[t[1]] - rest[t[0]]).norm(), (rest[t[2]] - rest[t[1]]).norm());
    for (double& w : weights) w *= std::sqrt(*stiffness.of(piece) * cloth.measure[t[1]]);
    stencils_.push_back({t, weights, pattern.slots<3>(t), damping.of(piece).value_or(0)});
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
    system.add_outer<3>(s.vertices, s.slots, s.weights, 1.0, s.damping);
  }
}

} // namespace taut
