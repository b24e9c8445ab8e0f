#include "src/forces/carried_tension.hpp"

#include <algorithm>

namespace taut {

std::vector<char> edges_with_pushes(const DistributedMesh& mesh, config::Constrain constrain) {
  std::vector<char> result(mesh.edges.size(), 0);
  if (constrain != config::Constrain::vertices) return result;
  const std::vector<char> is_thread = find_threads(mesh);
  for (std::size_t e = 0; e < result.size(); ++e) result[e] = is_thread[e] ? 0 : 1;
  return result;
}

CarriedTension::CarriedTension(const Cloth& cloth, const Pattern& pattern, std::vector<char> pushes)
    : cloth_(cloth), pushes_(std::move(pushes)) {
  for (Local i = 0; i < cloth.mesh.vertices.owned; ++i)
    for (const EdgeEnd& end : cloth.mesh.star_of(i))
      slots_.push_back(std::int32_t(pattern.slot(i, end.other)));
}

void CarriedTension::add_to(StepSystem& system, const State& state) {
  auto slot = slots_.begin();
  for (Local i = 0; i < cloth_.mesh.vertices.owned; ++i) {
    Vec3 pull = Vec3::Zero();
    for (const EdgeEnd& end : cloth_.mesh.star_of(i)) {
      const double density = state.multipliers.force_density[end.edge];
      const double q = pushes_[end.edge] ? density : std::max(density, 0.0);
      pull += q * (state.positions[end.other] - state.positions[i]);
      system.add_laplacian(i, end.other, *slot++, std::max(q, 0.0));
    }
    system.add_force(i, pull);
  }
}

} // namespace taut
