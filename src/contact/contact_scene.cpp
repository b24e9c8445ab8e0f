#include "src/contact/contact_scene.hpp"

namespace taut {

ContactScene::ContactScene(const Cloth& cloth, const Obstacles& obstacles, std::span<const Element> strings)
    : search(cloth, obstacles, strings), cloth_(cloth), obstacles_(obstacles),
      inverse_mass_(cloth.mesh.vertices.size()) {}

void ContactScene::begin(const State& state, double dt, std::span<const Vec3> velocities) {
  begin(state, dt);
  for (std::size_t i = 0; i < velocities.size(); ++i) target.cloth[i] += dt * velocities[i];
}

void ContactScene::begin(const State& state, double dt) {
  start_.cloth = state.positions;
  target.cloth = start_.cloth;
  obstacles_.place(state.time, start_.obstacles);
  obstacles_.place(state.time + dt, target.obstacles);
  turns_.clear();
  for (int body = 0; body < obstacles_.bodies(); ++body)
    turns_.push_back(obstacles_.turned(body, state.time, state.time + dt));
}

void ContactScene::gather_start() {
  gather(start_, start_field_);
  inverse_mass_field_.assign(search.size(), 0.0);
  std::copy_n(inverse_mass_.begin(), search.own(), inverse_mass_field_.begin());
  search.update(inverse_mass_field_);
}

} // namespace taut
