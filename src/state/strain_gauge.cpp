#include "src/state/strain_gauge.hpp"

#include <algorithm>
#include <cmath>

namespace taut {

StrainGauge::StrainGauge(const Cloth& cloth, config::Constrain constrain) : cloth_(cloth) {
  if (constrain == config::Constrain::vertices) metric_.emplace(cloth);
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

} // namespace taut
