#pragma once
#include "src/filters/velocity_filter.hpp"

namespace taut {

/// Of springs in place of constraints (Springs) nothing is left to correct; this tells their tensions at the
/// end of the step.
class SpringTension : public VelocityFilter {
public:
  /// `cloth` must outlive the filter.
  SpringTension(const Cloth& cloth, const config::Inextensibility& options);

  FilterReport apply(const State& start, double dt, const Freedom& freedom, Candidate& candidate) override;

private:
  const Cloth& cloth_;
  double stiffness_; ///< N
};

} // namespace taut
