#include "src/time/step_assembly.hpp"

namespace taut {

StepAssembly::StepAssembly(const Cloth& cloth, const Pattern& pattern, const Forces& forces,
                           config::Integrator integrator)
    : cloth_(cloth), forces_(forces), system_(pattern, cloth.mesh.vertices.size()) {
  if (integrator != config::Integrator::imex) return;
  loads_.emplace(pattern, cloth.mesh.vertices.size());
  load_impulse_.resize(cloth.mesh.vertices.size());
}

void StepAssembly::assemble(const StepStart& start) {
  system_.start(start.dt);
  for (Local i = 0; i < cloth_.mesh.vertices.owned; ++i) {
    system_.add_inertia(i, cloth_.mass[i], start.state.velocities[i]);
    system_.add_damping(i, cloth_.pieces[cloth_.piece_of(i)].material.damping.mass * cloth_.mass[i]);
  }
  add_forces(start);
}

/// Around x*, where they are linearised: x' - x* = (x - x*) + dt v'.
void StepAssembly::add_forces(const StepStart& start) {
  if (&start.linearized_at != &start.state) {
    alteration_.resize(start.state.positions.size());
    for (std::size_t i = 0; i < alteration_.size(); ++i)
      alteration_[i] = start.state.positions[i] - start.linearized_at.positions[i];
    system_.alter_positions(alteration_);
  }
  for (const auto& force : forces_)
    if (!loads_ || force->is_internal()) force->add_to(system_, start.linearized_at);
  if (loads_) add_explicit_loads(start.state, start.dt);
}

void StepAssembly::add_explicit_loads(const State& start, double dt) {
  loads_->start_explicit(dt);
  for (const auto& force : forces_)
    if (!force->is_internal()) force->add_to(*loads_, start);
  loads_->explicit_impulse(start.velocities, load_impulse_);
  for (Local i = 0; i < cloth_.mesh.vertices.owned; ++i) system_.add_force(i, load_impulse_[i] / dt);
}

} // namespace taut
