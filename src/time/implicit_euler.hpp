#pragma once
#include "src/filters/step_report.hpp"
#include "src/forces/force.hpp"
#include "src/linear/velocity_system.hpp"
#include "src/time/integrator.hpp"
#include "src/time/stepper_parts.hpp"

#include <optional>

namespace taut {

/// One linearised implicit-Euler step for the velocities [BW98 eq. 6], pins inside the system [BW98 section
/// 5]. BDF2 is made of such steps too: see Integrator.
///
/// With IMEX (implicit-explicit) only what the cloth does to itself is implicit: bending, shear, damping,
/// tension, all that is stiff. Loads, such as gravity and air drag, are those of the step's start, and leave
/// no trace in the matrix. Drag then limits the step to about twice the mass over the drag coefficient of a
/// vertex.
class ImplicitEuler {
public:
  /// All references must outlive the integrator. Collective.
  ImplicitEuler(const Cloth& cloth, const Pattern& pattern, const Forces& forces,
                const config::Velocity& options, config::Integrator integrator);

  /// `velocities` (local) holds the start velocities and, in the directions that `freedom` denies, the
  /// prescribed ones; on exit those at the end of the step, ghosts current. `reaction` (owned vertices): the
  /// forces in N that keep the prescribed velocities. Tells of the linear solver. Collective.
  StepReport predict(const StepStart& start, const Freedom& freedom, std::vector<Vec3>& velocities,
                     std::vector<Vec3>& reaction);

private:
  void add_forces(const StepStart& start);
  void add_explicit_loads(const State& start, double dt);

  const Cloth& cloth_;
  const Forces& forces_;
  double tolerance_;
  StepSystem step_;
  std::vector<Vec3> alteration_;    ///< from where forces are linearised to where the step starts
  std::optional<StepSystem> loads_; ///< of IMEX
  std::vector<Vec3> load_impulse_;
  VelocitySystem solver_;
};

} // namespace taut
