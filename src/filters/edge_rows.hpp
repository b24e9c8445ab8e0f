#pragma once
#include "src/filters/edge_constraints.hpp"
#include "src/linear/projection_system.hpp"

namespace taut {

/// What FastProjection needs to keep the length of every edge: EdgeConstraints and their linear system.
class EdgeRows {
public:
  /// As of EdgeConstraints. Collective.
  EdgeRows(const Cloth& cloth, const config::Inextensibility& options, double weight);

  /// For a step of `candidate`, which holds the tensions it starts from. Not collective.
  void start(const State& start, double dt, const Freedom& freedom, const Candidate& candidate);

  /// C and J at `x` (local vertices); returns the largest |strain|, infinite if one is not a number.
  /// Collective.
  double evaluate(std::span<const Vec3> x);

  /// d_mu, to the relative tolerance given; added to mu. Collective.
  SolveReport solve(double tolerance);

  /// W J^T d_mu at an owned vertex, in m. Not collective.
  Vec3 pulled(Local vertex) const {
    return constraints_.inverse_mass()[vertex] * constraints_.pull(vertex, constraints_.gradients(), change_);
  }

  /// The tensions, into the candidate. Not collective.
  void finish(Candidate& candidate) const;

private:
  EdgeConstraints constraints_;
  ProjectionSystem system_;
  std::vector<double> change_, mu_; ///< change_: first what is asked of the rows, then the answer
};

} // namespace taut
