#include "src/garment/sewing_pattern.hpp"

#include <fmt/format.h>

namespace taut::garment {

double signed_area(const Panel& panel) {
  double area = 0;
  for (const PatternEdge& edge : panel.edges) area += swept_area(edge.curve);
  return area;
}

std::string name_of(const SewingPattern& pattern, const SeamSide& side) {
  return fmt::format("{}.{}", pattern.panels[side.panel].name, side.edge);
}

std::string name_of(const SewingPattern& pattern, const Seam& seam) {
  return fmt::format("{}-{}", name_of(pattern, seam.sides[0]), name_of(pattern, seam.sides[1]));
}

} // namespace taut::garment
