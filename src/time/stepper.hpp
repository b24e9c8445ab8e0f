#pragma once
#include "src/filters/step_report.hpp"
#include "src/state/state.hpp"

namespace taut {

/// A way to make a step.
class Stepper {
public:
  virtual ~Stepper() = default;

  /// Proposes in `candidate` the state `dt` seconds after `state`. On entry the candidate is as
  /// `Candidate::reset_for` leaves it; on exit its positions and velocities, ghosts too, lie at the end of
  /// the step even where the step failed. Returns what it took, and why it cannot be accepted if the stepper
  /// knows. Collective.
  virtual StepReport propose(const State& state, double dt, Candidate& candidate) = 0;

  /// Keeps in `state`, which the accepted candidate of a step over `dt` seconds is about to replace, what
  /// later steps need of it. Not collective.
  virtual void store_history(State& /*state*/, double /*dt*/) const {}
};

} // namespace taut
