#include "src/filters/spring_tension.hpp"

namespace taut {

SpringTension::SpringTension(const Cloth& cloth, const config::Inextensibility& options)
    : cloth_(cloth), stiffness_(options.springs.value_or(config::Springs{}).stiffness) {}

FilterReport SpringTension::apply(const State& start, double dt, const Freedom&, Candidate& candidate) {
  const std::vector<Vec3>&x = start.positions, &v = candidate.velocities;
  for (Local e = 0; e < cloth_.mesh.edges.size(); ++e) {
    const auto& [a, b] = cloth_.mesh.edge_vertices[e];
    const double length = (x[b] - x[a] + dt * (v[b] - v[a])).norm(), l = cloth_.rest_length[e];
    candidate.multipliers.force_density[e] = stiffness_ * (1 / l - 1 / length);
  }
  return {};
}

} // namespace taut
