#pragma once
#include "src/time/filter_chain.hpp"
#include "src/time/implicit_euler.hpp"
#include "src/time/stepper.hpp"

namespace taut {

/// Predicts velocities by a linear system of all forces, then lets the filters change them [G07 section 4].
class PredictAndFilter : public Stepper {
public:
  /// Collective.
  PredictAndFilter(const StepperParts& parts, const Case& input);

  StepReport propose(const State& state, double dt, Candidate& candidate) override;
  void store_history(State& state, double dt) const override { integrator_.store_history(state, dt); }

private:
  StepReport predict(const StepStart& start, Candidate& candidate);

  const Pins& pins_;
  Integrator integrator_;
  FilterChain filters_;
  ImplicitEuler predictor_;
  Freedom freedom_;
};

} // namespace taut
