#pragma once
#include "src/constraints/averaged_metric.hpp"

#include <cmath>
#include <optional>

namespace taut {

/// What the strain limit holds for: the strain |d|/l - 1 of every constrained edge; or of every side of a
/// quad and every line alone, and of triangles sqrt(g) - 1 of their AveragedMetric g along warp and weft.
class StrainGauge {
public:
  /// `cloth` must outlive the gauge; its mesh as AveragedMetric asks where that is used. Collective.
  StrainGauge(const Cloth& cloth, config::Constrain constrain);

  /// Calls `visit(strain, vertices)` for all strains that this rank owns: of the two vertices of an edge, or
  /// around one.
  template<class Visit>
  void for_each(std::span<const Vec3> positions, Visit&& visit) const {
    for (Local e = 0; e < cloth_.mesh.edges.owned; ++e)
      if (!metric_ || is_thread_[e])
        visit(strain_of(cloth_, positions, e), std::span<const Local>(cloth_.mesh.edge_vertices[e]));
    for (Local i = 0; metric_ && i < cloth_.mesh.vertices.owned; ++i) {
      if (!metric_->has(i)) continue;
      for (const double g : metric_->at(i, positions))
        visit(std::sqrt(g) - 1.0, std::span<const Local>(&i, 1));
    }
  }

  /// Over all ranks. Collective.
  Strain measure(std::span<const Vec3> positions) const;

private:
  const Cloth& cloth_;
  std::optional<AveragedMetric> metric_;
  std::vector<char> is_thread_; ///< of local edges, see find_threads; with the metric
};

/// The largest of an averaged metric. Collective.
double largest_strain(const AveragedMetric& metric, std::span<const Vec3> positions);

/// That of edges. Collective.
inline Strain measure_strain(const Cloth& cloth, std::span<const Vec3> positions) {
  return StrainGauge(cloth, config::Constrain::edges).measure(positions);
}

} // namespace taut
