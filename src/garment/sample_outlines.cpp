#include "src/garment/sample_outlines.hpp"

#include "partition/error.hpp"
#include "src/config/suggest.hpp"
#include "src/garment/short_edges.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

namespace taut::garment {

namespace {

constexpr double growth = 0.5; ///< of segments, per length of the way along an edge
constexpr double next_larger =
    1.5; ///< segments that meet at a vertex, before they are rounded to whole numbers

/// How long segments are to be along an edge, all in parts of its length: as long as `inside`, and shorter
/// near the ends if they begin or end shorter.
struct Grading {
  double inside = 1, start = 1, end = 1;

  /// The ways, from each end, on which segments grow.
  std::array<double, 2> ways() const {
    const double one = (inside - start) / growth, two = (inside - end) / growth;
    if (one + two <= 1) return {one, two};
    const double first = std::clamp((end - start + growth) / (2 * growth), 0.0, 1.0); // they meet here
    return {first, 1 - first};
  }

  /// The numbers of segments on the growing way from the start, on the even one, and on that to the end.
  std::array<double, 3> counts() const {
    const auto [one, two] = ways();
    const auto grown = [](double from, double way) { return std::log1p(growth * way / from) / growth; };
    return {grown(start, one), std::max(0.0, 1 - one - two) / inside, grown(end, two)};
  }

  std::vector<double> parts() const {
    const auto [one, two] = ways();
    const auto [a, b, c] = counts();
    const double all = a + b + c;
    const int n = std::max(1, int(std::ceil(all - 0.25)));
    std::vector<double> parts{0};
    for (int i = 1; i < n; ++i) {
      const double at = all * i / n;
      if (a == 0 && c == 0)
        parts.push_back(double(i) / n);
      else if (at < a)
        parts.push_back(start * std::expm1(growth * at) / growth);
      else if (at <= a + b)
        parts.push_back(one + (at - a) * inside);
      else
        parts.push_back(1 - end * std::expm1(growth * (all - at)) / growth);
    }
    parts.push_back(1);
    return parts;
  }
};

/// An edge, or two that are sewn together.
struct Strip {
  struct Side {
    SeamSide edge;
    bool backwards; ///< against the strip
    double length;  ///< m
  };
  std::vector<Side> sides;
  Grading grading{};
};

/// All but those that are points.
std::vector<Strip> find_strips(const SewingPattern& pattern, const ShortEdges& points) {
  const auto side = [&](const SeamSide& s, bool backwards) {
    return Strip::Side{s, backwards, length_of(pattern.panels[s.panel].edges[s.edge].curve)};
  };
  std::vector<Strip> strips;
  for (const Seam& seam : pattern.seams) {
    const auto& [one, two] = seam.sides;
    if (points[one.panel][one.edge]) continue;
    strips.push_back({{side(one, false), side(two, seam.direction == SeamDirection::start_to_end)}});
  }
  for (const SeamSide& s : unsewn_edges(pattern))
    if (!points[s.panel][s.edge]) strips.push_back({{side(s, false)}});
  return strips;
}

/// Shortens segments next to shorter ones, and so those sewn to them, until there is nothing more to do. None
/// becomes shorter than the shortest was: seams in a circle, each gathered, could go on for ever.
void grade(std::vector<Strip>& strips, const ShortEdges& points) {
  double least = HUGE_VAL; // m
  for (const Strip& strip : strips)
    for (const auto& s : strip.sides) least = std::min(least, strip.grading.inside * s.length);
  for (;;) {
    std::vector<std::vector<double>> shortest; // segment at each vertex, m
    for (const auto& edges : points) shortest.emplace_back(edges.size(), HUGE_VAL);
    const auto at = [&](const Strip::Side& s, bool at_end) -> double& {
      auto& of_panel = shortest[s.edge.panel];
      const std::size_t start = (s.edge.edge + (at_end != s.backwards)) % of_panel.size();
      return of_panel[(start + points[s.edge.panel][start]) % of_panel.size()];
    };
    for (const Strip& strip : strips)
      for (const auto& s : strip.sides) {
        at(s, false) = std::min(at(s, false), strip.grading.start * s.length);
        at(s, true) = std::min(at(s, true), strip.grading.end * s.length);
      }
    bool changed = false;
    for (Strip& strip : strips) {
      Grading g = strip.grading;
      for (const auto& s : strip.sides) {
        g.start = std::min(g.start, next_larger * std::max(least, at(s, false)) / s.length);
        g.end = std::min(g.end, next_larger * std::max(least, at(s, true)) / s.length);
      }
      changed |= g.start < strip.grading.start || g.end < strip.grading.end;
      strip.grading = g;
    }
    if (!changed) return;
  }
}

using EdgePoints =
    std::vector<std::vector<std::vector<Vec2>>>; ///< of each edge of each panel, with both ends

/// Puts the point that stands for a short edge in its middle.
void draw_together(EdgePoints& points, const ShortEdges& drawn, const SewingPattern& pattern) {
  for (std::size_t p = 0; p < points.size(); ++p)
    for (std::size_t e = 0; e < points[p].size(); ++e) {
      if (!drawn[p][e]) continue;
      const std::size_t n = points[p].size();
      const Vec2 middle = points_along(pattern.panels[p].edges[e].curve, std::array{0.0, 0.5, 1.0})[1];
      points[p][(e + n - 1) % n].back() = points[p][(e + 1) % n].front() = middle;
      points[p][e] = {middle};
    }
}

} // namespace

void check_edge_lengths(const EdgeLengths& lengths, const SewingPattern& pattern) {
  std::vector<std::string> names;
  for (const Panel& p : pattern.panels) names.push_back(p.name);
  for (const auto& [name, length] : lengths.panels)
    if (std::ranges::find(names, name) == names.end()) {
      const auto meant = config::nearest(name, names);
      throw InputError(fmt::format("edge length of panel '{}': {} has no such panel{}", name, pattern.name,
                                   meant ? fmt::format(" (did you mean '{}'?)", *meant) : ""));
    }
}

double edge_length_of(const EdgeLengths& lengths, const Panel& panel) {
  if (const auto own = lengths.panels.find(panel.name); own != lengths.panels.end()) return own->second;
  return panel.edge_length.value_or(lengths.garment);
}

std::vector<int> Outline::of_edge(int edge) const {
  const bool last = edge + 1 == int(first.size());
  const int size = int(points.size()), end = last ? size : first[edge + 1];
  std::vector<int> numbers;
  for (int i = first[edge]; i <= end; ++i) numbers.push_back(i % size);
  return numbers;
}

std::vector<Outline> sample_outlines(const SewingPattern& pattern, const EdgeLengths& lengths) {
  const ShortEdges drawn_together = find_short_edges(pattern, lengths);
  std::vector<Strip> strips = find_strips(pattern, drawn_together);
  for (Strip& strip : strips) {
    double part = 1;
    for (const auto& s : strip.sides)
      part = std::min(part, edge_length_of(lengths, pattern.panels[s.edge.panel]) / s.length);
    strip.grading = {part, part, part};
  }
  grade(strips, drawn_together);
  EdgePoints points;
  for (const Panel& p : pattern.panels) points.emplace_back(p.edges.size());
  for (const Strip& strip : strips) {
    const std::vector<double> parts = strip.grading.parts();
    std::vector<double> mirrored;
    for (const double part : parts) mirrored.insert(mirrored.begin(), 1 - part);
    for (const auto& s : strip.sides) {
      const Curve& curve = pattern.panels[s.edge.panel].edges[s.edge.edge].curve;
      points[s.edge.panel][s.edge.edge] = points_along(curve, s.backwards ? mirrored : parts);
    }
  }
  draw_together(points, drawn_together, pattern);
  std::vector<Outline> outlines(points.size());
  for (std::size_t p = 0; p < points.size(); ++p)
    for (const auto& edge : points[p]) {
      outlines[p].first.push_back(int(outlines[p].points.size()));
      outlines[p].points.insert(outlines[p].points.end(), edge.begin(), edge.end() - 1);
    }
  return outlines;
}

} // namespace taut::garment
