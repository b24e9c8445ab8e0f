#include "src/garment/short_edges.hpp"

#include <algorithm>
#include <span>

namespace taut::garment {

namespace {

constexpr double least_part = 0.25; ///< of the length of the mesh's edges

class Finder {
public:
  Finder(const SewingPattern& pattern, const EdgeLengths& lengths) : pattern_(pattern), lengths_(lengths) {
    for (const Panel& p : pattern.panels) {
      found.emplace_back(p.edges.size(), 0);
      kept_.push_back(int(p.edges.size()));
    }
  }

  /// Draws an edge, or two that are sewn together, to a point if that may be.
  void draw(std::span<const SeamSide> sides) {
    const auto may = [&](const SeamSide& s) {
      return is_short(s) && is_alone(s) &&
             kept_[s.panel] - std::ranges::count(sides, s.panel, &SeamSide::panel) >= 3;
    };
    if (!std::ranges::all_of(sides, may) || meet(sides.front(), sides.back())) return;
    for (const SeamSide& s : sides) {
      found[s.panel][s.edge] = 1;
      --kept_[s.panel];
    }
  }

  ShortEdges found;

private:
  bool is_short(const SeamSide& s) const {
    const Panel& panel = pattern_.panels[s.panel];
    return length_of(panel.edges[s.edge].curve) < least_part * edge_length_of(lengths_, panel);
  }
  bool is_alone(const SeamSide& s) const {
    const auto& of_panel = found[s.panel];
    const std::size_t n = of_panel.size();
    return !of_panel[(s.edge + 1) % n] && !of_panel[(s.edge + n - 1) % n];
  }
  bool meet(const SeamSide& a, const SeamSide& b) const {
    const int n = int(found[a.panel].size());
    return a.panel == b.panel && ((a.edge + 1) % n == b.edge || (b.edge + 1) % n == a.edge);
  }

  const SewingPattern& pattern_;
  const EdgeLengths& lengths_;
  std::vector<int> kept_; ///< edges of each panel
};

} // namespace

ShortEdges find_short_edges(const SewingPattern& pattern, const EdgeLengths& lengths) {
  Finder finder(pattern, lengths);
  for (const Seam& seam : pattern.seams) finder.draw(seam.sides);
  for (const SeamSide& s : unsewn_edges(pattern)) finder.draw({&s, 1});
  return finder.found;
}

} // namespace taut::garment
