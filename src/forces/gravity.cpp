#include "src/forces/gravity.hpp"

namespace taut {

double Gravity::energy(const State& state) const {
  double energy = 0;
  const Vec3 acceleration = acceleration_.at(state.time);
  for (Local i = 0; i < cloth_.mesh.vertices.owned; ++i)
    energy -= cloth_.mass[i] * acceleration.dot(state.positions[i]);
  return energy;
}

void Gravity::add_to(StepSystem& system, const State& state) {
  const Vec3 acceleration = acceleration_.at(state.time + system.dt());
  for (Local i = 0; i < cloth_.mesh.vertices.owned; ++i) system.add_force(i, cloth_.mass[i] * acceleration);
}

} // namespace taut
