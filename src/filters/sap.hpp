#pragma once
#include "src/filters/constrained_step.hpp"
#include "src/linear/kkt_system.hpp"
#include "src/linear/velocity_system.hpp"

namespace taut {

/// Step and project [G07 section 4.1]: x is the point of the manifold C(x) = 0 that is closest to x0 in the
/// norm of the masses, the extremal point of W(x, mu) = 1/2 (x - x0)^T M (x - x0) + mu^T C(x). Given
/// tensions, W is least at
///
///     x(mu) = (M + G(mu))^-1 M x0,
///
/// G being the Laplacian of the edges weighted by 2 mu/l; Newton's method on what is left, C(x(mu)) = a mu,
/// takes (J (M + G)^-1 J^T + a) d_mu = C - a mu in an iteration. In theory the end is that of Icd [G07,
/// theorem]; on the way there forces balance exactly here and both residuals fall together there. It asks
/// that M + G be positive definite, that is, of edges under strong compression for a smaller step.
class Sap : public VelocityFilter {
public:
  /// `cloth` and `pattern` must outlive the filter. Collective.
  Sap(const Cloth& cloth, const Pattern& pattern, const config::Inextensibility& options);

  FilterReport apply(const State& start, double dt, const Freedom& freedom, Candidate& candidate) override;

private:
  SolveReport iterate(const Freedom& freedom, double strain);
  SolveReport move_to_least(const Freedom& freedom);
  void weigh_edges();

  config::Inextensibility options_;
  ConstrainedStep step_;
  std::vector<std::int32_t> slots_;
  VertexMatrix stiffened_mass_;
  VelocitySystem vertices_;
  KktSystem system_;
  std::vector<Vec3> no_force_, momentum_, dx_;
  std::vector<double> weight_, gap_, d_mu_;
};

} // namespace taut
