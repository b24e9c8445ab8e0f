#pragma once
#include "src/linear/metric_system.hpp"
#include "src/state/averaged_metric.hpp"
#include "src/state/freedom.hpp"
#include "src/state/state.hpp"

#include <optional>

namespace taut {

/// What FastProjection needs to keep the metric averaged at every vertex (AveragedMetric): constraints C = s
/// (g - 1) for warp and for weft, with s = sqrt(A), A the area of cloth at the vertex.
///
/// Their multipliers are told by mu = h^2 lambda = h^2 s sigma/2, where sigma is the membrane stress averaged
/// there, in N/m: the part of the cloth's tension that works when the metric changes. An edge whose squared
/// length is in the metrics around it with the weights w has the force density q = sum A w sigma over these.
///
/// On most meshes some rows nearly depend on others. The compliance c, in 1/N, makes C = a mu with a = 4 c
/// s/h^2, so that a strip as wide as s strains by c for each newton of its tension.
class MetricSet {
public:
  /// As of EdgeSet, for a mesh of triangles alone. The default compliance is that of EdgeConstraints.
  /// Collective.
  MetricSet(const Cloth& cloth, const config::Inextensibility& options, double weight);

  void start(const State& start, double dt, const Freedom& freedom, const Candidate& candidate);
  double evaluate(std::span<const Vec3> x);
  SolveReport solve(double tolerance);
  Vec3 pulled(Local vertex) const;
  void finish(Candidate& candidate) const;

private:
  /// Where a side of a triangle adds to the columns of a vertex.
  struct Entry {
    EdgeEnd end;
    Vec2 weight;        ///< s w, 1/m
    std::size_t target; ///< in `columns_`
  };
  void find_columns();
  void fill_columns();
  bool can_change(Local vertex) const;

  const Cloth& cloth_;
  AveragedMetric metric_;
  bool carries_tension_;
  double compliance_;
  std::vector<Entry> entries_;
  std::vector<std::size_t> column_begin_{0};
  std::vector<Local> column_rows_;
  std::optional<MetricSystem> system_;
  double dt_ = 0;
  Freedom freedom_;
  std::vector<double> scale_, inverse_mass_; ///< s, and 1/m_i or 0 if held; of local vertices
  std::vector<Vec3> sides_;                  ///< of local edges, m
  std::vector<std::array<Vec3, 2>> columns_; ///< dC/dx of each row that a vertex has a part in
  std::vector<Vec2> values_, residual_, scaled_compliance_, change_, mu_;
  std::vector<double> edge_change_, edge_sum_; ///< J^T d_mu, and its sum over the step, by squared length
};

} // namespace taut
