#pragma once
#include "src/filters/velocity_filter.hpp"
#include "src/linear/projection_system.hpp"

namespace taut {

/// Fast Projection [G07 section 4.2, algorithm 1]: from the candidate end positions x, until the largest strain is within the
/// limit,
///
///     (J W J^T) mu = C(x),   x <- x - W J^T mu,
///
/// with C = |d|^2/l - l on every constrained edge, J = dC/dx and W the inverse masses (0 where the
/// velocity is prescribed). mu = h^2 lambda; the sum of all mu is the tension of the step: force density
/// q = 2 sum(mu) / (l h^2) on top of the carried one. Linear momentum of a free cloth is kept to round-off whatever the
/// accuracy of the linear solver.
class FastProjection : public VelocityFilter {
 public:
  /// `cloth` must outlive the filter. Collective.
  FastProjection(const Cloth& cloth, const config::Inextensibility& options);

  FilterReport apply(const State& start, double dt, std::span<const char> prescribed, Candidate& candidate) override;

 private:
  double evaluate(std::span<const char> prescribed);
  void correct(double dt, Candidate& candidate);

  const Cloth& cloth_;
  config::Inextensibility options_;
  ProjectionSystem system_;
  std::vector<Vec3> positions_, gradient_;
  std::vector<double> inverse_mass_, constraint_, mu_, total_;
};

} // namespace taut
