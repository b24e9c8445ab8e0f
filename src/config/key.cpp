#include "src/config/key.hpp"

#include <cmath>
#include <fmt/format.h>

namespace taut::config {

bool Range::contains(double value) const {
  return (open_low ? value > low : value >= low) && (open_high ? value < high : value <= high);
}

std::string Range::text() const {
  const std::string above = fmt::format("{} {}", open_low ? "above" : "at least", low);
  const std::string below = fmt::format("{} {}", open_high ? "below" : "at most", high);
  if (std::isinf(low)) return std::isinf(high) ? "any number" : below;
  return std::isinf(high) ? above : above + " and " + below;
}

} // namespace taut::config
