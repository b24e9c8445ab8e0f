#pragma once
#include "src/filters/velocity_filter.hpp"
#include "src/linear/projection_system.hpp"

namespace taut {

/// Fast Projection [G07 section 4.2, algorithm 1]: from the candidate end positions x, until the largest
/// strain is within the limit,
///
///     (J W J^T + a) d_mu = C(x) - a mu,   x <- x - W J^T d_mu,   mu <- mu + d_mu,
///
/// with C = |d|^2/l - l on every constrained edge, J = dC/dx and W = S_i / m_i the inverse masses in the
/// directions in which vertices may move. mu = h^2 lambda is the tension of the step, that carried from the
/// last one included: the force density of an edge is q = 2 mu / (l h^2), in N/m. Linear momentum of a free
/// cloth is kept to round-off whatever the accuracy of the linear solver.
///
/// a = 4 l c / h^2 lets an edge stretch by the strain c per newton of tension. Without it a thread pulled
/// straight between two pins makes the system singular: what little it may sag asks for a tension without
/// bound. The default c is such that a taut thread which bears the whole weight W of the cloth stretches by e
/// = a tenth of the limit: it sags by s with e = 8/3 (s/L)^2 and T = W L/(8 s), so c = e/T = 4.9 e^(3/2) / W.
///
/// Every step projects at least once, even if the candidate is within the limit: a cloth that uses up the
/// limit first has to be stopped by a jerk.
class FastProjection : public VelocityFilter {
public:
  /// `cloth` must outlive the filter; `weight` is that of the whole cloth in N. Collective.
  FastProjection(const Cloth& cloth, const config::Inextensibility& options, double weight);

  FilterReport apply(const State& start, double dt, const Freedom& freedom, Candidate& candidate) override;

  double compliance() const { return compliance_; } ///< c, in 1/N

private:
  void start(double dt, const Freedom& freedom, const Candidate& candidate);
  double evaluate(const Freedom& freedom);
  void correct(double dt, const Freedom& freedom, Candidate& candidate);

  const Cloth& cloth_;
  config::Inextensibility options_;
  double compliance_;
  ProjectionSystem system_;
  std::vector<Vec3> positions_, gradient_;
  std::vector<double> inverse_mass_, shift_, residual_, change_, mu_;
};

} // namespace taut
