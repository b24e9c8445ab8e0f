#include "src/garment/sewing_pattern.hpp"

#include <fmt/format.h>

namespace taut::garment {

double signed_area(const Panel& panel) {
  double area = 0;
  for (const PatternEdge& edge : panel.edges) area += swept_area(edge.curve);
  return area;
}

std::vector<SeamSide> unsewn_edges(const SewingPattern& pattern) {
  std::vector<std::vector<char>> sewn; // of each edge of each panel
  for (const Panel& p : pattern.panels) sewn.emplace_back(p.edges.size(), 0);
  for (const Seam& seam : pattern.seams)
    for (const SeamSide& s : seam.sides) sewn[s.panel][s.edge] = 1;
  std::vector<SeamSide> unsewn;
  for (int p = 0; p < int(sewn.size()); ++p)
    for (int e = 0; e < int(sewn[p].size()); ++e)
      if (!sewn[p][e]) unsewn.push_back({p, e});
  return unsewn;
}

std::string name_of(const SewingPattern& pattern, const SeamSide& side) {
  return fmt::format("{}.{}", pattern.panels[side.panel].name, side.edge);
}

std::string name_of(const SewingPattern& pattern, const Seam& seam) {
  return fmt::format("{}-{}", name_of(pattern, seam.sides[0]), name_of(pattern, seam.sides[1]));
}

} // namespace taut::garment
