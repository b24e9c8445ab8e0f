#pragma once
#include "src/constraints/edge_constraints.hpp"
#include "src/constraints/thread_stiffness.hpp"
#include "src/linear/projection_system.hpp"
#include "src/linear/yarn_system.hpp"

#include <optional>

namespace taut {

/// The lengths of all edges (EdgeConstraints) as a ConstraintSet. Alone it moves vertices in the metric of
/// the masses and of ThreadStiffness (the latter with `solver: cg` only), with contact in that of the masses,
/// and in Newton's method in that which it is given.
class EdgeSet {
public:
  /// `cloth` must outlive the set. Collective.
  EdgeSet(const Cloth& cloth, const config::Inextensibility& options,
          ConstraintUse use = ConstraintUse::alone);

  /// As a part of a larger set, which solves for all: of local edges those marked in `constrained`, as
  /// EdgeConstraints takes it. Collective.
  EdgeSet(const Cloth& cloth, const config::Inextensibility& options, ConstraintUse use,
          std::vector<char> constrained);

  void start(const State& start, double dt, const Freedom& freedom, const Candidate& candidate);
  double evaluate(std::span<const Vec3> x);
  double strain(std::span<const Vec3> x) const { return constraints_.strain(x); }
  void finish(Candidate& candidate) const;

  /// For a part of a larger set: whether it has a local edge, and what of the tension that the candidate
  /// carries others bear (of local edges, N/m). Not collective.
  bool has(Local edge) const { return constraints_.has(edge); }
  void subtract_force_densities(std::span<const double> of_others);

  SolveReport solve(double tolerance);
  Vec3 displacement(Local vertex) const {
    const Vec3 by_mass =
        inverse_mass()[vertex] * constraints_.pull(vertex, constraints_.gradients(), change_);
    return uses_threads() ? Vec3(by_mass - threads_->held_back(vertex)) : by_mass;
  }

  std::size_t rows() const { return program_compliance_.size(); }
  std::span<const double> program_compliance() const { return program_compliance_; }
  void keep_strain(double part);
  void program_residual(std::span<double> residual) const;
  void program_tolerance(double part_of_limit, std::span<double> tolerance) const;
  void program_guess(std::span<double> guess) const;
  void factor(std::span<const double> metric);
  void precondition(std::span<const double> r, std::span<double> s) const { yarns_->solve(r, s); }
  void multiply(std::span<const double> z, std::span<double> product) { system_->multiply(z, product); }
  void begin_spread(std::span<const double> z);
  void end_spread(std::span<Vec3> field);
  void subtract_difference(std::span<const Vec3> u, std::span<double> rows) const;
  void add(std::span<const double> z);

  void residual(std::span<double> rows) const { constraints_.residual(mu_, rows); }
  void tension_weights(std::span<double> weights) const;
  void multipliers(std::span<double> rows) const;
  std::vector<RowEdge> row_edges() const;
  std::vector<RowPlace> row_places() const;
  std::span<const Vec3> gradients() const { return constraints_.gradients(); }

  std::span<const double> inverse_mass() const { return constraints_.inverse_mass(); }
  const Freedom& freedom() const { return constraints_.freedom(); }

private:
  const DistributedMesh& mesh() const { return constraints_.cloth().mesh; }
  bool uses_threads() const { return threads_ && threads_->acts(); }
  SolveReport solve_with_threads(double tolerance);
  void add_change();

  EdgeConstraints constraints_;
  config::Inextensibility options_;
  ConstraintUse use_;
  std::optional<ProjectionSystem> system_; ///< where it solves for itself; in the metric last asked for
  std::optional<ThreadStiffness> threads_; ///< made when it is first needed
  std::optional<YarnSystem> yarns_;        ///< where it does not
  const State* start_ = nullptr;           ///< of the step in hand
  double dt_ = 0, strain_kept_ = 0;
  std::vector<double> change_, mu_; ///< of local edges; change_: first what is asked of the rows, then d_mu
  std::vector<double> added_;       ///< to mu in this step, of local edges, where the next one starts from it
  std::vector<double> slopes_;      ///< of what owned edges yield: a, less where they are pulled hard
  std::vector<double> program_compliance_;
};

} // namespace taut
