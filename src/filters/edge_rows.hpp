#pragma once
#include "src/filters/thread_stiffness.hpp"
#include "src/linear/projection_system.hpp"
#include "src/state/state.hpp"

#include <optional>

namespace taut {

/// What FastProjection needs to keep the length of every edge: EdgeConstraints and their linear system, in
/// the metric of the masses and of ThreadStiffness (the latter with `solver: cg` only).
class EdgeSet {
public:
  /// As of EdgeConstraints. Collective.
  EdgeSet(const Cloth& cloth, const config::Inextensibility& options, double weight);

  /// For a step of `candidate`, which holds the tensions it starts from. Not collective.
  void start(const State& start, double dt, const Freedom& freedom, const Candidate& candidate);

  /// C and J at `x` (local vertices); returns the largest |strain|, infinite if one is not a number.
  /// Collective.
  double evaluate(std::span<const Vec3> x);

  /// d_mu, to the relative tolerance given; added to mu. Collective.
  SolveReport solve(double tolerance);

  /// G^-1 J^T d_mu at an owned vertex, in m. Not collective.
  Vec3 pulled(Local vertex) const {
    const Vec3 by_mass =
        constraints_.inverse_mass()[vertex] * constraints_.pull(vertex, constraints_.gradients(), change_);
    return uses_threads() ? Vec3(by_mass - threads_->held_back(vertex)) : by_mass;
  }

  /// The tensions, into the candidate. Not collective.
  void finish(Candidate& candidate) const;

private:
  bool uses_threads() const { return threads_ && threads_->acts(); }
  SolveReport solve_with_threads(double tolerance);

  EdgeConstraints constraints_;
  ProjectionSystem system_;
  bool is_by_cg_;
  std::optional<ThreadStiffness> threads_; ///< made when it is first needed
  std::vector<double> change_, mu_;        ///< change_: first what is asked of the rows, then the answer
};

} // namespace taut
