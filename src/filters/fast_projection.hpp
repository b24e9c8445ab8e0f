#pragma once
#include "src/constraints/mixed_set.hpp"
#include "src/filters/velocity_filter.hpp"

namespace taut {

/// Fast Projection [G07 section 4.2, algorithm 1]: from the candidate end positions x, until the largest
/// strain is within the limit,
///
///     (J W J^T + a) d_mu = C(x) - a mu,   x <- x - W J^T d_mu,   mu <- mu + d_mu,
///
/// with the constraints C, their gradients J and the compliance a of `Set` (EdgeSet or MetricSet), and W =
/// S_i / m_i the inverse masses in the directions in which vertices may move; for edges, the inverse metric
/// of ThreadStiffness stands in its place. mu = h^2 lambda is the tension of the step, that carried from the
/// last one included. Linear momentum of a free cloth is kept to round-off whatever the accuracy of the
/// linear solver.
///
/// Every step projects at least once, even if the candidate is within the limit: a cloth that uses up the
/// limit first has to be stopped by a jerk.
template<ConstraintSet Set>
class FastProjection : public VelocityFilter {
public:
  /// `cloth` must outlive the filter. Collective.
  FastProjection(const Cloth& cloth, const config::Inextensibility& options);

  FilterReport apply(const State& start, double dt, const Freedom& freedom, Candidate& candidate) override;

private:
  const Cloth& cloth_;
  config::Inextensibility options_;
  Set set_;
};

} // namespace taut
