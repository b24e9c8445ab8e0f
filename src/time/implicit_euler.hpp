#pragma once
#include "src/filters/step_report.hpp"
#include "src/linear/velocity_system.hpp"
#include "src/state/resolve.hpp"
#include "src/time/step_assembly.hpp"

namespace taut {

/// The one that serves velocities best: see src/linear/README.md.
SolverOptions::Preconditioner velocity_preconditioner(const Resolved& resolved);

/// One linearised implicit-Euler step for the velocities [BW98 eq. 6], pins inside the system [BW98 section
/// 5].
class ImplicitEuler {
public:
  /// All references must outlive the integrator. Collective.
  ImplicitEuler(const Cloth& cloth, const Pattern& pattern, const Forces& forces,
                const config::Velocity& options, config::Integrator integrator,
                SolverOptions::Preconditioner preconditioner);

  /// `velocities` (local) holds the start velocities and, in the directions that `freedom` denies, the
  /// prescribed ones; on exit those at the end of the step, ghosts current. `reaction` (owned vertices): the
  /// forces in N that keep the prescribed velocities. Tells of the linear solver. Collective.
  StepReport predict(const StepStart& start, const Freedom& freedom, std::vector<Vec3>& velocities,
                     std::vector<Vec3>& reaction);

private:
  const Cloth& cloth_;
  double tolerance_;
  StepAssembly assembly_;
  VelocitySystem solver_;
};

} // namespace taut
