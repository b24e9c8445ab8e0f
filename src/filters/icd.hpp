#pragma once
#include "src/filters/constrained_step.hpp"
#include "src/linear/kkt_system.hpp"

namespace taut {

/// Implicit constraint direction [G07 section 4.1]: tensions act along the edges as they lie at the end of
/// the step,
///
///     F = M (x - x0) + J(x)^T mu = 0,   C(x) = a mu,
///
/// solved by Newton's method for x and mu together. J^T mu = G(mu) x with the Laplacian G of the edges
/// weighted by 2 mu/l, so an iteration solves
///
///     [ M + G   J^T ] [ dx   ]     [ F        ]
///     [ J       -a  ] [ d_mu ] = - [ C - a mu ].
///
/// It ends when the strain is within the limit e and max |F_i|/m_i, by how much a vertex is out of place,
/// within e times the shortest edge. With `cg` edges under compression are left out of G in the matrix, which
/// so stays positive definite.
class Icd : public VelocityFilter {
public:
  /// `cloth` and `pattern` must outlive the filter. Collective.
  Icd(const Cloth& cloth, const Pattern& pattern, const config::Inextensibility& options);

  FilterReport apply(const State& start, double dt, const Freedom& freedom, Candidate& candidate) override;

private:
  SolveReport iterate(const Freedom& freedom, double strain);
  double force_residual();

  config::Inextensibility options_;
  ConstrainedStep step_;
  KktSystem system_;
  double shortest_;
  std::vector<Vec3> force_, dx_;
  std::vector<double> weight_, gap_, d_mu_;
};

} // namespace taut
