#include "src/time/implicit_euler.hpp"

#include "src/linear/modified_cg.hpp"

namespace taut {

namespace {

SolverOptions solver_options(const config::Velocity& options) {
  using Kind = SolverOptions::Kind;
  using Constraints = SolverOptions::Constraints;
  const bool projected = options.constraints == config::ConstraintSolver::projected;
  return {.kind = options.solver == config::LinearSolver::mumps ? Kind::mumps : Kind::cg,
          .max_iterations = options.max_iterations,
          .constraints = projected ? Constraints::projected : Constraints::filtered};
}

} // namespace

ImplicitEuler::ImplicitEuler(const Cloth& cloth, const Pattern& pattern, const Forces& forces,
                             const config::Velocity& options, config::Integrator integrator)
    : cloth_(cloth), forces_(forces), tolerance_(options.tolerance),
      step_(pattern, cloth.mesh.vertices.size()), solver_(cloth.mesh, pattern, solver_options(options)) {
  if (integrator != config::Integrator::imex) return;
  loads_.emplace(pattern, cloth.mesh.vertices.size());
  load_impulse_.resize(cloth.mesh.vertices.size());
}

StepReport ImplicitEuler::predict(const StepStart& start, const Freedom& freedom,
                                  std::vector<Vec3>& velocities, std::vector<Vec3>& reaction) {
  const double dt = start.dt;
  step_.start(dt);
  for (Local i = 0; i < cloth_.mesh.vertices.owned; ++i) {
    step_.add_inertia(i, cloth_.mass[i], start.state.velocities[i]);
    step_.add_damping(i, cloth_.pieces[cloth_.piece_of(i)].material.damping.mass * cloth_.mass[i]);
  }
  add_forces(start);
  const SolveReport solved = solver_.solve(step_.matrix(), step_.rhs(), freedom, tolerance_, velocities);
  StepReport report;
  report.velocity_iterations = solved.iterations;
  if (!solved.failure.empty()) report.failure = "the velocity solver failed: " + solved.failure;
  if (!any_of(cloth_.mesh.comm, !freedom.all_free())) { // penalty springs reach across ranks
    reaction.assign(cloth_.mesh.vertices.owned, Vec3::Zero());
    return report;
  }
  constraint_impulse(step_.matrix(), step_.rhs(), freedom, velocities, reaction);
  for (Vec3& r : reaction) r /= dt;
  return report;
}

/// Around x*, where they are linearised: x' - x* = (x - x*) + dt v'.
void ImplicitEuler::add_forces(const StepStart& start) {
  if (&start.linearized_at != &start.state) {
    alteration_.resize(start.state.positions.size());
    for (std::size_t i = 0; i < alteration_.size(); ++i)
      alteration_[i] = start.state.positions[i] - start.linearized_at.positions[i];
    step_.alter_positions(alteration_);
  }
  for (const auto& force : forces_)
    if (!loads_ || force->is_internal()) force->add_to(step_, start.linearized_at);
  if (loads_) add_explicit_loads(start.state, start.dt);
}

void ImplicitEuler::add_explicit_loads(const State& start, double dt) {
  loads_->start_explicit(dt);
  for (const auto& force : forces_)
    if (!force->is_internal()) force->add_to(*loads_, start);
  loads_->explicit_impulse(start.velocities, load_impulse_);
  for (Local i = 0; i < cloth_.mesh.vertices.owned; ++i) step_.add_force(i, load_impulse_[i] / dt);
}

} // namespace taut
