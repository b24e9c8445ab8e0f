#include "src/config/gravity.hpp"

#include <algorithm>

namespace taut::config {

Vec3 Gravity::at(double time) const {
  const auto after = std::upper_bound(keyframes.begin(), keyframes.end(), time,
                                      [](double t, const GravityKeyframe& k) { return t < k.time; });
  if (after == keyframes.begin()) return keyframes.front().value;
  if (after == keyframes.end()) return keyframes.back().value;
  const GravityKeyframe& before = after[-1];
  const double part = (time - before.time) / (after->time - before.time);
  return (1 - part) * before.value + part * after->value;
}

double Gravity::largest() const {
  double largest = 0;
  for (const GravityKeyframe& k : keyframes) largest = std::max(largest, k.value.norm());
  return largest;
}

} // namespace taut::config
