#pragma once
#include "src/filters/edge_sweeps.hpp"
#include "src/filters/velocity_filter.hpp"

namespace taut {

/// Strain limiting by sweeps over the edges (EdgeSweeps, without compliance), Jacobi or Gauss-Seidel, until
/// the largest strain is within the limit [G07 section 2 and figure 5]. As the limit falls, or the mesh is
/// refined, the number of sweeps grows without bound.
class StrainLimiting : public VelocityFilter {
public:
  /// `cloth` must outlive the filter. Collective.
  StrainLimiting(const Cloth& cloth, const config::Inextensibility& options);

  FilterReport apply(const State& start, double dt, const Freedom& freedom, Candidate& candidate) override;

private:
  FilterReport sweep_to_limit();

  const Cloth& cloth_;
  config::Inextensibility options_;
  EdgeSweeps sweeps_;
  std::vector<Vec3> x_;
  std::vector<double> s_;
};

} // namespace taut
