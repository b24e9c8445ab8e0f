#pragma once
#include "src/constraints/edge_set.hpp"
#include "src/constraints/metric_set.hpp"
#include "src/constraints/row_parts.hpp"

namespace taut {

/// For meshes of triangles and other cells, as a ConstraintSet: the lengths of the sides of quads and of
/// lines (EdgeSet), and of triangles the metric averaged at their corners (MetricSet). Rows are those of the
/// one, then those of the other; edges and vertices that have no part in it have rows that nothing moves.
///
/// Each kind is preconditioned as it is alone: the blocks of a block-diagonal preconditioner, which leaves
/// out what couples rows along the seam between triangles and quads.
class MixedSet {
public:
  /// `cloth` must outlive the set; its mesh has the sides of triangles as edges. Collective.
  MixedSet(const Cloth& cloth, const config::Inextensibility& options,
           ConstraintUse use = ConstraintUse::alone);

  void start(const State& start, double dt, const Freedom& freedom, const Candidate& candidate);
  double evaluate(std::span<const Vec3> x);
  double strain(std::span<const Vec3> x) const { return std::max(edges_.strain(x), metric_.strain(x)); }
  void finish(Candidate& candidate) const;

  SolveReport solve(double tolerance);
  Vec3 displacement(Local vertex) const;

  std::size_t rows() const { return edges_.rows() + metric_.rows(); }
  std::span<const double> program_compliance() const { return compliance_; }
  void keep_strain(double part);
  void program_residual(std::span<double> residual) const;
  void program_tolerance(double part_of_limit, std::span<double> tolerance) const;
  void program_guess(std::span<double> guess) const;
  void factor(std::span<const double> metric);
  void precondition(std::span<const double> r, std::span<double> s) const;
  void multiply(std::span<const double> z, std::span<double> product);
  void begin_spread(std::span<const double> z);
  void end_spread(std::span<Vec3> field);
  void subtract_difference(std::span<const Vec3> u, std::span<double> rows);
  void add(std::span<const double> z);

  void residual(std::span<double> rows) const;
  void tension_weights(std::span<double> weights) const;
  void multipliers(std::span<double> rows) const;
  std::vector<RowEdge> row_edges() const;
  std::vector<RowPlace> row_places() const;
  std::span<const Vec3> gradients() const { return metric_.gradients(); }

  std::span<const double> inverse_mass() const { return metric_.inverse_mass(); }
  const Freedom& freedom() const { return metric_.freedom(); }

private:
  RowParts parts() const { return {edges_.rows()}; }
  const Cloth& cloth_;
  EdgeSet edges_;
  MetricSet metric_;
  std::vector<double> compliance_;     ///< of owned rows
  std::vector<double> inverse_metric_; ///< given last to `factor`
  std::vector<Vec3> push_;             ///< room for local vertices
};

} // namespace taut
