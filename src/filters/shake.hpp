#pragma once
#include "src/filters/constrained_step.hpp"
#include "src/linear/projection_system.hpp"

namespace taut {

/// SHAKE [Ryckaert, Ciccotti, Berendsen 1977; G07 section 4.1]: tensions act along the edges as they lie at
/// the start of the step, x(mu) = x0 - W J_s^T mu, and Newton's method finds those for which C(x(mu)) = a mu:
///
///     (J(x) W J_s^T + a) d_mu = C(x) - a mu.
///
/// The matrix is not symmetric. With `matrix: newton` it is made in every iteration; with `lagged` once a
/// step, and again after an iteration that did not halve the strain [Barth, Kuczera, Leimkuhler, Skeel 1995].
///
/// It fails where edges change their direction much in a step [G07 section 4.1, figure 2]: there may be no
/// tension along the old directions that brings edges to length, or the matrix is singular although there is
/// one.
class Shake : public VelocityFilter {
public:
  /// `cloth` must outlive the filter. Collective.
  Shake(const Cloth& cloth, const config::Inextensibility& options);

  FilterReport apply(const State& start, double dt, const Freedom& freedom, Candidate& candidate) override;

  /// The same, known by the name of the method it is part of.
  FilterReport apply(std::string_view method, const State& start, double dt, const Freedom& freedom,
                     Candidate& candidate);

  /// As the last step left it.
  ConstrainedStep& step() { return step_; }

private:
  SolveReport iterate(double strain);

  config::Inextensibility options_;
  ConstrainedStep step_;
  ProjectionSystem system_;
  double last_strain_ = 0; ///< at which the iteration before began; 0: there was none
  std::vector<Vec3> start_gradients_;
  std::vector<double> gap_, d_mu_;
};

} // namespace taut
