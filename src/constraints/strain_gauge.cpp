#include "src/constraints/strain_gauge.hpp"

#include <algorithm>
#include <cmath>

namespace taut {

StrainGauge::StrainGauge(const Cloth& cloth, config::Constrain constrain) : cloth_(cloth) {
  if (constrain != config::Constrain::vertices) return;
  metric_.emplace(cloth);
  is_thread_ = find_threads(cloth.mesh);
}

Strain StrainGauge::measure(std::span<const Vec3> positions) const {
  double max = 0;
  std::array<double, 2> squares{}; // their sum, their number
  for_each(positions, [&](double strain, std::span<const Local>) {
    max = std::max(max, std::isfinite(strain) ? std::abs(strain) : HUGE_VAL);
    squares[0] += strain * strain;
    squares[1] += 1;
  });
  max = max_over(cloth_.mesh.comm, max);
  sum_in_place(cloth_.mesh.comm, squares);
  return {max, squares[1] > 0 ? std::sqrt(squares[0] / squares[1]) : 0.0};
}

double largest_strain(const AveragedMetric& metric, std::span<const Vec3> positions) {
  const DistributedMesh& mesh = metric.cloth().mesh;
  double max = 0;
  for (Local i = 0; i < mesh.vertices.owned; ++i) {
    if (!metric.has(i)) continue;
    for (const double g : metric.at(i, positions)) {
      const double strain = std::sqrt(g) - 1.0;
      max = std::max(max, std::isfinite(strain) ? std::abs(strain) : HUGE_VAL);
    }
  }
  return max_over(mesh.comm, max);
}

} // namespace taut
