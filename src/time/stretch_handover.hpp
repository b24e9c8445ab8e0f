#pragma once
#include "src/constraints/averaged_metric.hpp"
#include "src/state/resolve.hpp"
#include "src/state/state.hpp"

namespace taut {

/// What stretch springs of triangles bear in a prediction and a projection then takes from them, given to the
/// multipliers that keep warp and weft: the method of multipliers [Hestenes 1969].
///
/// The prediction is in the metric A = M + h^2 K of the step, with the springs in K; the projection finds its
/// multipliers in that of the masses. Where cloth lacks the tension q to be at rest, the prediction strains
/// it by about q/k, and the projection, which takes that strain back, adds M/A of q to the multipliers: a
/// 245th, with the stiffness that triangles have by default and steps of 10 ms. As K is nearly J^T D J, the
/// multiplier in the metric of the step is (J A^-1 J^T)^-1 C = (J M^-1 J^T)^-1 C + D C. The first is what the
/// projection found; the second, stiffness times strain, is what this adds: all of q is then found at once.
class StretchHandover {
public:
  /// `cloth` must outlive it. Collective.
  StretchHandover(const Cloth& cloth, const Resolved& resolved);

  /// Before the projection, at the predicted positions of local vertices, in m. Not collective.
  void start(std::span<const Vec3> positions);
  /// After it: adds to the candidate's stresses and force densities what its positions bear less than those
  /// given to `start`. Collective over neighbours.
  void add_to(Candidate& candidate) const;

private:
  Vec2 tension(Local vertex, std::span<const Vec3> positions) const;

  const Cloth& cloth_;
  AveragedMetric metric_;
  std::vector<Vec2> stiffness_; ///< N/m, of warp and weft around owned vertices
  std::vector<Vec2> predicted_; ///< N/m: what owned vertices bore in the prediction
};

} // namespace taut
