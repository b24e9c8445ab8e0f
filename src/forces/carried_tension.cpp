#include "src/forces/carried_tension.hpp"

namespace taut {

CarriedTension::CarriedTension(const Cloth& cloth, const Pattern& pattern, Pushes pushes)
    : cloth_(cloth), pushes_(pushes) {
  for (Local i = 0; i < cloth.mesh.vertices.owned; ++i)
    for (const EdgeEnd& end : cloth.mesh.star_of(i))
      slots_.push_back(std::int32_t(pattern.slot(i, end.other)));
}

void CarriedTension::add_to(StepSystem& system, const State& state) {
  auto slot = slots_.begin();
  for (Local i = 0; i < cloth_.mesh.vertices.owned; ++i) {
    Vec3 pull = Vec3::Zero();
    for (const EdgeEnd& end : cloth_.mesh.star_of(i)) {
      const double q = carried(state.multipliers.force_density[end.edge], pushes_);
      pull += q * (state.positions[end.other] - state.positions[i]);
      system.add_laplacian(i, end.other, *slot++, std::max(q, 0.0));
    }
    system.add_force(i, pull);
  }
}

} // namespace taut
