#include "src/contact/gap_gauge.hpp"

#include <algorithm>

namespace taut {

GapGauge::GapGauge(const Cloth& cloth, const Obstacles& obstacles, double reach)
    : search_(cloth, obstacles), reach_(reach) {}

std::vector<double> GapGauge::measure(std::span<const Vec3> cloth, std::span<const Vec3> obstacles) {
  search_.find({cloth, cloth, obstacles, obstacles}, reach_);
  search_.gather(cloth, obstacles, field_);
  std::vector<double> gaps(search_.size(), reach_);
  for (const Pair& pair : search_.pairs()) {
    const Approach here = approach(pair, at(pair, field_));
    for (int i = 0; i < 4; ++i)
      if (here.weights[i] != 0) gaps[pair.vertices[i]] = std::min(gaps[pair.vertices[i]], here.gap);
  }
  search_.take_least(gaps);
  gaps.resize(search_.own());
  return gaps;
}

} // namespace taut
