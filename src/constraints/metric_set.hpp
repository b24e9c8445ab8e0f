#pragma once
#include "src/constraints/averaged_metric.hpp"
#include "src/constraints/constraint_set.hpp"
#include "src/linear/metric_system.hpp"

#include <optional>

namespace taut {

/// The metric averaged at every vertex (AveragedMetric) as a ConstraintSet: C = s (g - 1) for warp and for
/// weft, with s = sqrt(A), A the area of cloth at the vertex. Rows are [warp, weft] of each owned vertex.
///
/// Their multipliers are told by mu = h^2 lambda = h^2 s sigma/2, where sigma is the membrane stress averaged
/// there, in N/m: the part of the cloth's tension that works when the metric changes. An edge whose squared
/// length is in the metrics around it with the weights w has the force density q = sum A w sigma over these.
///
/// On most meshes some rows nearly depend on others. The compliance c, in 1/N, makes C = a mu with a = 4 c
/// s/h^2, so that a strip as wide as s strains by c for each newton of its tension.
class MetricSet {
public:
  /// `cloth` must outlive the set; its mesh as AveragedMetric asks. Vertices without a metric have rows that
  /// nothing moves. Collective.
  MetricSet(const Cloth& cloth, const config::Inextensibility& options,
            ConstraintUse use = ConstraintUse::alone);

  void start(const State& start, double dt, const Freedom& freedom, const Candidate& candidate);
  double evaluate(std::span<const Vec3> x);
  double strain(std::span<const Vec3> x) const;
  void finish(Candidate& candidate) const;

  /// In a larger set: what mu is as force densities of local edges, in N/m; and what `finish` does, where the
  /// candidate has the force densities of others already. The latter collective over neighbours.
  void force_densities(std::span<double> on_edges) const;
  void finish_beside_edges(Candidate& candidate) const;

  SolveReport solve(double tolerance);
  Vec3 displacement(Local vertex) const;

  std::size_t rows() const { return 2 * std::size_t(cloth_.mesh.vertices.owned); }
  std::span<const double> program_compliance() const { return in_rows(scaled_compliance_); }
  void keep_strain(double part);
  void program_residual(std::span<double> residual) const;
  void program_tolerance(double part_of_limit, std::span<double> tolerance) const;
  void program_guess(std::span<double> guess) const;
  void factor(std::span<const double> metric);
  void precondition(std::span<const double> r, std::span<double> s) const { system_->precondition(r, s); }
  void multiply(std::span<const double> z, std::span<double> product) const { system_->multiply(z, product); }
  void begin_spread(std::span<const double> z);
  void end_spread(std::span<Vec3> field);
  void subtract_difference(std::span<const Vec3> u, std::span<double> rows);
  void add(std::span<const double> z);

  void residual(std::span<double> rows) const;
  void tension_weights(std::span<double> weights) const;
  void multipliers(std::span<double> rows) const;
  std::vector<RowEdge> row_edges() const;
  std::vector<RowPlace> row_places() const;
  std::span<const Vec3> gradients() const { return gradients_; }

  std::span<const double> inverse_mass() const { return inverse_mass_; }
  const Freedom& freedom() const { return freedom_; }

private:
  /// Where a side of a triangle adds to the columns of a vertex.
  struct Entry {
    EdgeEnd end;
    Vec2 weight;        ///< s w, 1/m
    std::size_t target; ///< in `columns_`
  };
  static std::span<const double> in_rows(const std::vector<Vec2>& values) {
    return {reinterpret_cast<const double*>(values.data()), 2 * values.size()};
  }
  void take_rows(std::span<const double> rows);
  void find_columns();
  void fill_columns();
  void take_compliances();
  bool can_change(Local vertex) const;
  Yield yield_at(Local vertex, double mu) const;
  double inverse_mass_around(Local vertex) const;
  SolverOptions options_of_system() const;
  void spread_to_edges(std::span<const Vec2> values, std::span<double> on_edges) const;
  void add_change();
  void store_stress(Candidate& candidate) const;

  const Cloth& cloth_;
  config::Inextensibility options_;
  ConstraintUse use_;
  ComplianceBounds bounds_;
  AveragedMetric metric_;
  std::vector<Entry> entries_;
  std::vector<std::size_t> column_begin_{0};
  std::vector<Local> column_rows_;
  std::optional<MetricSystem> system_;
  // of the step in hand
  double dt_ = 0, strain_kept_ = 0;
  const State* start_ = nullptr;
  Freedom freedom_;
  std::vector<double> scale_, inverse_mass_; ///< s, and 1/m_i or 0 if held; of local vertices
  std::vector<Vec3> gradients_;              ///< 2 d of local edges, m
  std::vector<std::array<Vec3, 2>> columns_; ///< dC/dx of each row that a vertex has a part in
  std::vector<Vec2> metrics_, residual_, scaled_compliance_; ///< of owned vertices
  std::vector<Vec2> change_, mu_;                            ///< of local vertices
  std::vector<double> edge_values_;                          ///< of z, or d_mu, by squared length
};

} // namespace taut
