#pragma once
#include "src/constraints/mixed_set.hpp"
#include "src/constraints/row_parts.hpp"
#include "src/constraints/triangle_bounds.hpp"

namespace taut {

/// A ConstraintSet of averages with bounds for single triangles: rows of `Set`, then those of TriangleBounds.
/// Strain is that of the set, or what single triangles strain in parts of their bound times the limit, so
/// that it is within the limit where both are. For projections; Newton's method takes sets without bounds.
template<ConstraintSet Set>
class BoundedSet {
public:
  /// `cloth` must outlive the set. Collective.
  BoundedSet(const Cloth& cloth, const config::Inextensibility& options,
             ConstraintUse use = ConstraintUse::alone)
      : cloth_(cloth), limit_(options.strain), set_(cloth, options, use), bounds_(cloth, options) {}

  void start(const State& start, double dt, const Freedom& freedom, const Candidate& candidate);
  double evaluate(std::span<const Vec3> x);
  double strain(std::span<const Vec3> x) const;
  void finish(Candidate& candidate) const { set_.finish(candidate); }

  SolveReport solve(double tolerance);
  Vec3 displacement(Local vertex) const { return set_.displacement(vertex) + bounds_.displacement(vertex); }

  std::size_t rows() const { return set_.rows() + bounds_.rows(); }
  /// See OneSidedSet.
  std::size_t equations() const { return set_.rows(); }
  void program_bounds(std::span<double> lower, std::span<double> upper) const {
    bounds_.program_bounds(lower, upper);
  }
  std::span<const double> program_compliance() const { return compliance_; }
  void keep_strain(double part) {
    set_.keep_strain(part);
    bounds_.keep_strain(part);
  }
  void program_residual(std::span<double> residual) const;
  void program_tolerance(double part_of_limit, std::span<double> tolerance) const;
  void program_guess(std::span<double> guess) const;
  void residual(std::span<double> rows) const;
  void factor(std::span<const double> metric);
  void precondition(std::span<const double> r, std::span<double> s) const;
  void begin_spread(std::span<const double> z);
  void end_spread(std::span<Vec3> field);
  void subtract_difference(std::span<const Vec3> u, std::span<double> rows);
  void add(std::span<const double> z);

  std::span<const double> inverse_mass() const { return set_.inverse_mass(); }
  const Freedom& freedom() const { return set_.freedom(); }

private:
  RowParts parts() const { return {set_.rows()}; }
  const Cloth& cloth_;
  double limit_;
  Set set_;
  TriangleBounds bounds_;
  std::vector<double> compliance_;     ///< of owned rows
  std::span<const double> multiplier_; ///< of bounds, between the halves of a spread
};

} // namespace taut
