#include "src/time/implicit_euler.hpp"

#include "src/linear/modified_cg.hpp"

namespace taut {

namespace {

SolverOptions solver_options(const config::Velocity& options) {
  return {options.solver == config::LinearSolver::mumps ? SolverOptions::Kind::mumps
                                                        : SolverOptions::Kind::cg,
          options.max_iterations,
          options.constraints == config::ConstraintSolver::projected ? SolverOptions::Constraints::projected
                                                                     : SolverOptions::Constraints::filtered};
}

} // namespace

ImplicitEuler::ImplicitEuler(const Cloth& cloth, const Pattern& pattern, const Forces& forces,
                             const config::Velocity& options)
    : cloth_(cloth), forces_(forces), tolerance_(options.tolerance),
      step_(pattern, cloth.mesh.vertices.size()), solver_(cloth.mesh, pattern, solver_options(options)) {}

SolveReport ImplicitEuler::predict(const State& start, double dt, const Freedom& freedom,
                                   std::vector<Vec3>& velocities, std::vector<Vec3>& reaction) {
  step_.start(dt);
  const double damping = cloth_.material.damping.mass;
  for (Local i = 0; i < cloth_.mesh.vertices.owned; ++i) {
    step_.add_inertia(i, cloth_.mass[i], start.velocities[i]);
    step_.add_damping(i, damping * cloth_.mass[i]);
  }
  for (const auto& force : forces_) force->add_to(step_, start);
  const SolveReport report = solver_.solve(step_.matrix(), step_.rhs(), freedom, tolerance_, velocities);
  reaction.assign(cloth_.mesh.vertices.owned, Vec3::Zero());
  if (freedom.all_free()) return report;
  reaction = constraint_impulse(step_.matrix(), step_.rhs(), freedom, velocities);
  for (Vec3& r : reaction) r /= dt;
  return report;
}

} // namespace taut
