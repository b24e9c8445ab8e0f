#pragma once
#include "src/filters/shake.hpp"

namespace taut {

/// RATTLE [Andersen 1983]: the positions of Shake, and then velocities that change the length of no edge:
/// from v, that which leads to these positions, v' = v - W J^T eta with J v' = 0, so (J W J^T + a) eta = J v,
/// all at the end of the step.
class Rattle : public VelocityFilter {
public:
  /// `cloth` must outlive the filter. Collective.
  Rattle(const Cloth& cloth, const config::Inextensibility& options);

  FilterReport apply(const State& start, double dt, const Freedom& freedom, Candidate& candidate) override;

private:
  SolveReport project_velocities(Candidate& candidate);

  Shake shake_;
  ProjectionSystem system_;
  std::vector<double> rates_, eta_;
};

} // namespace taut
