#include "src/time/implicit_euler.hpp"

#include "src/linear/modified_cg.hpp"

#include <algorithm>

namespace taut {

namespace {

SolverOptions solver_options(const config::Velocity& options, SolverOptions::Preconditioner preconditioner) {
  using Kind = SolverOptions::Kind;
  using Constraints = SolverOptions::Constraints;
  const bool projected = options.constraints == config::ConstraintSolver::projected;
  return {.kind = options.solver == config::LinearSolver::mumps ? Kind::mumps : Kind::cg,
          .max_iterations = options.max_iterations,
          .preconditioner = preconditioner,
          .constraints = projected ? Constraints::projected : Constraints::filtered};
}

/// How the two compare, and what a tighter one changes: src/linear/README.md.
double default_tolerance(SolverOptions::Preconditioner preconditioner) {
  return preconditioner == SolverOptions::Preconditioner::grids ? 1e-2 : 3e-4;
}

} // namespace

SolverOptions::Preconditioner velocity_preconditioner(const Resolved& resolved) {
  const auto resists = [](const Vec2& stretch) { return stretch.maxCoeff() > 0; };
  return std::ranges::any_of(resolved.stretch, resists) ? SolverOptions::Preconditioner::grids
                                                        : SolverOptions::Preconditioner::axis;
}

ImplicitEuler::ImplicitEuler(const Cloth& cloth, const Pattern& pattern, const Forces& forces,
                             const config::Velocity& options, config::Integrator integrator,
                             SolverOptions::Preconditioner preconditioner)
    : cloth_(cloth), tolerance_(options.tolerance.value_or(default_tolerance(preconditioner))),
      assembly_(cloth, pattern, forces, integrator),
      solver_(cloth.mesh, pattern, solver_options(options, preconditioner)) {}

StepReport ImplicitEuler::predict(const StepStart& start, const Freedom& freedom,
                                  std::vector<Vec3>& velocities, std::vector<Vec3>& reaction) {
  assembly_.assemble(start);
  const StepSystem& step = assembly_.system();
  const SolveReport solved = solver_.solve(step.matrix(), step.rhs(), freedom, tolerance_, velocities);
  StepReport report;
  report.velocity_iterations = solved.iterations;
  if (!solved.failure.empty()) report.failure = "the velocity solver failed: " + solved.failure;
  if (!any_of(cloth_.mesh.comm, !freedom.all_free())) { // penalty springs reach across ranks
    reaction.assign(cloth_.mesh.vertices.owned, Vec3::Zero());
    return report;
  }
  constraint_impulse(step.matrix(), step.rhs(), freedom, velocities, reaction);
  for (Vec3& r : reaction) r /= start.dt;
  return report;
}

} // namespace taut
