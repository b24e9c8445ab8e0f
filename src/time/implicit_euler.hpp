#pragma once
#include "src/forces/force.hpp"
#include "src/linear/velocity_system.hpp"
#include "src/state/pins.hpp"

#include <memory>

namespace taut {

using Forces = std::vector<std::unique_ptr<Force>>;

/// One linearised implicit-Euler step for the velocities [BW98 eq. 6], pins inside the system [BW98 section
/// 5].
class ImplicitEuler {
public:
  /// All references must outlive the integrator. Collective.
  ImplicitEuler(const Cloth& cloth, const Pattern& pattern, const Forces& forces,
                const config::Velocity& options);

  /// `velocities` (local) holds the start velocities and, in the directions that `freedom` denies, the
  /// prescribed ones; on exit those at the end of the step, ghosts current. `reaction` (owned vertices): the
  /// forces in N that keep the prescribed velocities. Collective.
  SolveReport predict(const State& start, double dt, const Freedom& freedom, std::vector<Vec3>& velocities,
                      std::vector<Vec3>& reaction);

private:
  const Cloth& cloth_;
  const Forces& forces_;
  double tolerance_;
  StepSystem step_;
  VelocitySystem solver_;
};

} // namespace taut
