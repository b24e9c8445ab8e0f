#include "src/forces/springs.hpp"

#include <algorithm>
#include <cmath>

namespace taut {

Springs::Springs(const Cloth& cloth, const Pattern& pattern, double stiffness,
                 const PerPiece<double>& damping)
    : cloth_(cloth), stiffness_(stiffness) {
  const DistributedMesh& mesh = cloth.mesh;
  for (Local e = 0; e < mesh.edges.size(); ++e) {
    const auto& ends = mesh.edge_vertices[e];
    if (mesh.owns_vertex(ends[0]) || mesh.owns_vertex(ends[1]))
      elements_.push_back({e, pattern.slots<2>(ends), damping.of(cloth.piece_of(ends[0])).value_or(0)});
  }
  std::sort(elements_.begin(), elements_.end(), [&](const Element& a, const Element& b) {
    return mesh.edges.original[a.edge] < mesh.edges.original[b.edge];
  });
}

double Springs::energy(const State& state) const {
  double energy = 0;
  for (Local e = 0; e < cloth_.mesh.edges.owned; ++e) {
    const double strain = strain_of(cloth_, state.positions, e);
    energy += 0.5 * stiffness_ * cloth_.rest_length[e] * strain * strain;
  }
  return energy;
}

void Springs::add_to(StepSystem& system, const State& state) {
  for (const Element& element : elements_) {
    const auto& [a, b] = cloth_.mesh.edge_vertices[element.edge];
    const double l = cloth_.rest_length[element.edge];
    const Vec3 d = state.positions[b] - state.positions[a];
    const double length = d.norm();
    if (length == 0) continue; // no direction, no force
    const Vec3 n = d / length, tension = stiffness_ * (length / l - 1) * n;
    system.add_force(a, tension);
    system.add_force(b, -tension);
    const double across = std::max(1 - l / length, 0.0), k = stiffness_ / l;
    system.add_outer<2>({a, b}, element.slots, {-1, 1}, across * k, 0.0);
    system.add_rank_one(std::array<Local, 4>{a, b, a, a}, {-n, n, Vec3::Zero(), Vec3::Zero()},
                        (1 - across) * k, element.damping * k);
  }
}

} // namespace taut
