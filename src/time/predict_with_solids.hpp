#pragma once
#include "src/contact/solid_constraints.hpp"
#include "src/time/filter_chain.hpp"
#include "src/time/implicit_euler.hpp"
#include "src/time/stepper.hpp"

namespace taut {

/// The same as PredictAndFilter with vertices kept on obstacles within the prediction, for contact by penalty
/// [BW98 sections 5 and 6].
class PredictWithSolids : public Stepper {
public:
  /// Adds the friction of obstacles to the forces. Throws InputError for a thickness that the mesh cannot
  /// have. Collective.
  PredictWithSolids(const StepperParts& parts, const Case& input);

  StepReport propose(const State& state, double dt, Candidate& candidate) override;

private:
  StepStart alter(const State& state, double dt, Candidate& candidate);
  StepReport predict(const StepStart& start, Candidate& candidate);

  const Pins& pins_;
  FilterChain filters_;
  ImplicitEuler predictor_;
  SolidConstraints solids_;
  State altered_; ///< what a step starts from
  Freedom freedom_;
};

} // namespace taut
