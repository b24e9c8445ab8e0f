#pragma once
#include "src/filters/velocity_filter.hpp"
#include "src/time/integrator.hpp"
#include "src/time/stepper_parts.hpp"
#include "src/time/stretch_handover.hpp"

namespace taut {

/// What follows the prediction of a step: the filters of the case in their order, and what they add to the
/// forces of pins.
class FilterChain {
public:
  /// Collective.
  FilterChain(const StepperParts& parts, const Case& input);

  /// Gives the candidate of a step from `state` the tension that its prediction carries, from which filters
  /// start. Not collective.
  void carry_tension(const State& state, Candidate& candidate) const;

  /// Applies the filters to the velocities of `candidate`, unless the step has failed, makes its positions,
  /// and completes its reactions. What that took is added to `report`. Collective.
  void apply(const StepStart& start, const Freedom& freedom, Candidate& candidate, StepReport& report);

private:
  void apply_filters(const StepStart& start, const Freedom& freedom, Candidate& candidate,
                     StepReport& report);
  void add_pull(const State& state, const Freedom& freedom, Candidate& candidate) const;
  void add_pressure(const State& state, const Freedom& freedom, Candidate& candidate) const;
  double carried(const State& state, std::size_t edge) const;

  const Cloth& cloth_;
  config::Inextensibility limits_;
  bool holds_limit_, contact_is_filter_;
  std::vector<char> pushes_; ///< see edges_with_pushes
  std::optional<StretchHandover> stretch_;
  std::vector<std::unique_ptr<VelocityFilter>> filters_;
};

} // namespace taut
