#include "partition/error.hpp"
#include "src/garment/pattern_block.hpp"
#include "src/garment/plane.hpp"
#include "src/garment/read_pattern.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <fmt/format.h>
#include <map>

namespace taut::garment {

namespace {

using config::Spot;
using config::Tree;

/// What a pattern says of itself; the initial values are those of one written by hand.
struct Properties {
  PatternStyle style;
  bool absolute_controls = false; ///< of curvature in the old form, a bare list
  bool normalize_translation = false;
};

Properties read_properties(const PatternBlock& root, bool is_json) {
  Properties p;
  p.style.unknown = is_json ? UnknownKeys::passed_over : UnknownKeys::refused;
  const std::vector<std::string> names{"units_in_meter", "curvature_coords", "normalize_panel_translation",
                                       "normalized_edge_loops"};
  const char* old =
      "an old form of specification, in which edges of a panel may stand in any order: put them in "
      "order, each from where the one before ends, and set normalized_edge_loops: true";
  if (!root.has("properties")) {
    if (is_json) root.spot().fail(fmt::format("properties.normalized_edge_loops is missing: {}", old));
    return p;
  }
  const PatternBlock block(root.at("properties").tree, "properties", names, p.style.unknown);
  if (is_json && !block.has("normalized_edge_loops"))
    block.spot().fail(fmt::format("normalized_edge_loops is missing: {}", old));
  if (block.has("normalized_edge_loops") && !flag_at(block.at("normalized_edge_loops")))
    block.at("normalized_edge_loops").fail(old);
  if (block.has("units_in_meter")) {
    const Spot spot = block.at("units_in_meter");
    const double units = number_at(spot);
    if (!(units > 0)) spot.fail(fmt::format("{} is out of range; it must be above 0, as 100 for cm", units));
    p.style.metres_per_unit = 1 / units;
  }
  if (block.has("curvature_coords"))
    p.absolute_controls =
        name_at(block.at("curvature_coords"), {"relative", "absolute"}, "kind of coordinates");
  p.normalize_translation =
      block.has("normalize_panel_translation") && flag_at(block.at("normalize_panel_translation"));
  return p;
}

Vec2 point_at(const Spot& spot, const PatternStyle& style) {
  if (spot.tree.items.size() != 2) config::fail_type(spot, "a point, e.g. [0.3, 0.1]");
  return {length_at(spot.item(0), style), length_at(spot.item(1), style)};
}

/// A control point, in parts of the edge: along it, and across to the left.
Vec2 control_at(const Spot& spot, const Vec2& start, const Vec2& end) {
  if (spot.tree.items.size() != 2)
    config::fail_type(spot, "a control point, e.g. [0.5, 0.2]: parts of the edge, along it and to its left");
  const double along = number_at(spot.item(0)), across = number_at(spot.item(1));
  constexpr double farthest = 10;
  if (std::abs(along) > farthest || std::abs(across) > farthest)
    spot.fail(
        fmt::format("control point [{}, {}] is out of range: it lies more than {} lengths of the edge away; "
                    "give parts of the edge, along it and to its left",
                    along, across, farthest));
  const Vec2 run = end - start;
  return start + along * run + across * Vec2(-run[1], run[0]);
}

Curve circle_at(const Spot& params, const Vec2& start, const Vec2& end, const PatternStyle& style) {
  if (params.tree.items.size() != 3)
    config::fail_type(params, "[radius, large_arc, right], e.g. [0.2, 0, 1]");
  const double radius = length_at(params.item(0), style);
  const auto size = flag_at(params.item(1)) ? ArcSize::large : ArcSize::small;
  const auto turn = flag_at(params.item(2)) ? Turn::counter_clockwise : Turn::clockwise;
  const auto made = arc(start, end, radius, size, turn);
  if (!made)
    params.item(0).fail(
        fmt::format("radius {:.4g} m is out of range: the ends of the edge are {:.4g} m apart; it "
                    "must be at least half of that",
                    radius, (end - start).norm()));
  return *made;
}

Curve curve_at(const Spot& spot, const Vec2& start, const Vec2& end, const Properties& p) {
  if (spot.tree.kind == Tree::Kind::list) { // the old form
    if (!p.absolute_controls) return quadratic(start, control_at(spot, start, end), end);
    return quadratic(start, point_at(spot, p.style), end);
  }
  const PatternBlock block(spot.tree, spot.path, {"type", "params"}, p.style.unknown);
  const std::size_t type = name_at(block.at("type"), {"quadratic", "cubic", "circle"}, "type of curvature");
  const Spot params = block.at("params");
  if (type == 2) return circle_at(params, start, end, p.style);
  if (list_at(params, type + 1, "control points, e.g. [[0.5, 0.2]]").size() != type + 1)
    config::fail_type(params, type == 0 ? "a list of one control point" : "a list of two control points");
  const Vec2 first = control_at(params.item(0), start, end);
  if (type == 0) return quadratic(start, first, end);
  return Bezier{{start, first, control_at(params.item(1), start, end), end}};
}

/// The edges of a panel, which are to be one closed loop.
std::vector<PatternEdge> read_edges(const Spot& spot, const std::vector<Vec2>& vertices,
                                    const Properties& p) {
  const std::size_t count = list_at(spot, 2, "edges, two at least").size();
  std::vector<PatternEdge> edges;
  std::vector<std::array<int, 2>> ends;
  for (std::size_t e = 0; e < count; ++e) {
    const PatternBlock block(spot.item(e).tree, spot.item(e).path, {"endpoints", "curvature", "label"},
                             p.style.unknown);
    const Spot endpoints = block.at("endpoints");
    if (endpoints.tree.items.size() != 2)
      config::fail_type(endpoints, "two numbers of vertices, e.g. [0, 1]");
    const int from = index_at(endpoints.item(0), vertices.size(), "vertex"),
              to = index_at(endpoints.item(1), vertices.size(), "vertex");
    const Vec2 &start = vertices[from], &end = vertices[to];
    if ((end - start).norm() < 1e-9)
      endpoints.fail(
          fmt::format("the edge has no length: vertices {} and {} lie on one another; remove one", from, to));
    ends.push_back({from, to});
    edges.push_back(
        {block.has("curvature") ? curve_at(block.at("curvature"), start, end, p) : line(start, end),
         block.text("label"), block.spot().tree.place});
  }
  for (std::size_t e = 0; e < count; ++e) {
    const std::size_t before = (e + count - 1) % count;
    if (ends[before][1] != ends[e][0])
      spot.item(e).fail(
          fmt::format("the outline is open: edge {} begins at vertex {}, but edge {} before it ends at "
                      "vertex {}; the edges are one closed loop, each from where the one before ends",
                      e, ends[e][0], before, ends[before][1]));
  }
  return edges;
}

/// Points by their labels, less `origin`.
std::vector<PatternPoint> read_points(const Spot& spot, const Vec2& origin, const PatternStyle& style) {
  if (spot.tree.kind != Tree::Kind::map)
    config::fail_type(spot, "points by their labels, e.g. {button: [0.1, 0.3]}");
  std::vector<PatternPoint> points;
  for (const config::Entry& e : spot.tree.entries)
    points.push_back(
        {e.key, point_at({e.value, spot.path + "." + e.key, spot.key}, style) - origin, e.place});
  return points;
}

Panel read_panel(const config::Entry& entry, const Properties& p) {
  const PatternBlock block(
      entry.value, "panels." + entry.key,
      {"translation", "rotation", "vertices", "edges", "label", "edge", "grain", "points"}, p.style.unknown);
  Panel panel;
  panel.name = entry.key;
  panel.place = entry.place;
  panel.label = block.text("label");
  std::vector<Vec2> vertices;
  const Spot points = block.at("vertices");
  for (std::size_t i = 0; i < list_at(points, 2, "points, two at least").size(); ++i)
    vertices.push_back(point_at(points.item(i), p.style));
  if (block.has("translation")) {
    const Spot spot = block.at("translation");
    if (spot.tree.items.size() != 3) config::fail_type(spot, "a list of 3 lengths, e.g. [0, 1, 0.2]");
    for (int k = 0; k < 3; ++k) panel.translation[k] = length_at(spot.item(k), p.style);
  }
  Vec2 mean = Vec2::Zero();
  if (p.normalize_translation) {
    for (const Vec2& v : vertices) mean += v / double(vertices.size());
    for (Vec2& v : vertices) v -= mean;
    panel.translation.head<2>() += mean;
  }
  if (block.has("rotation")) {
    Vec3 angles;
    config::read(block.at("rotation"), angles);
    angles *= degree;
    panel.rotation =
        (Eigen::AngleAxisd(angles[2], Vec3::UnitZ()) * Eigen::AngleAxisd(angles[1], Vec3::UnitY()) *
         Eigen::AngleAxisd(angles[0], Vec3::UnitX()))
            .toRotationMatrix();
  }
  panel.edges = read_edges(block.at("edges"), vertices, p);
  if (block.has("points")) panel.points = read_points(block.at("points"), mean, p.style);
  if (block.has("grain")) panel.grain = degree * number_at(block.at("grain"));
  if (block.has("edge")) {
    panel.edge_length = length_at(block.at("edge"), p.style);
    if (!(*panel.edge_length > 0))
      block.at("edge").fail("must be above 0; it is the length of the edges of the mesh");
  }
  return panel;
}

std::vector<std::string> names_of(const std::vector<Panel>& panels) {
  std::vector<std::string> names;
  for (const Panel& p : panels) names.push_back(p.name);
  return names;
}

/// Panels in the order that `panel_order` gives, then all others.
void put_in_order(std::vector<Panel>& panels, const PatternBlock& body) {
  if (!body.has("panel_order")) return;
  const auto names = names_of(panels);
  const Spot spot = body.at("panel_order");
  std::vector<std::size_t> rank(panels.size(), panels.size());
  for (std::size_t i = 0; i < list_at(spot, 0, "names of panels").size(); ++i) {
    std::size_t& r = rank[name_at(spot.item(i), names, "panel")];
    if (r < panels.size()) spot.item(i).fail("the panel stands in the list already; remove one");
    r = i;
  }
  std::vector<std::size_t> order(panels.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return rank[i]; });
  std::vector<Panel> sorted;
  for (const std::size_t i : order) sorted.push_back(std::move(panels[i]));
  panels = std::move(sorted);
}

SeamSide side_at(const Spot& spot, const SewingPattern& pattern, const PatternStyle& style) {
  const PatternBlock block(spot.tree, spot.path, {"panel", "edge"}, style.unknown);
  SeamSide side;
  side.panel = int(name_at(block.at("panel"), names_of(pattern.panels), "panel"));
  side.edge = index_at(block.at("edge"), pattern.panels[side.panel].edges.size(),
                       fmt::format("edge of panel '{}' with number", pattern.panels[side.panel].name));
  return side;
}

void read_seams(const Spot& spot, SewingPattern& pattern, const PatternStyle& style) {
  std::map<std::pair<int, int>, std::string> sewn; // edges, with the stitch they are in
  for (std::size_t s = 0; s < list_at(spot, 0, "stitches").size(); ++s) {
    const Spot stitch = spot.item(s);
    const std::size_t size = list_at(stitch, 2, "two edges, {panel: .., edge: ..} each").size();
    if (size > 3) config::fail_type(stitch, "two edges and no more than the word right_wrong");
    Seam seam;
    seam.place = stitch.tree.place;
    for (std::size_t k = 0; k < 2; ++k) {
      const SeamSide side = seam.sides[k] = side_at(stitch.item(k), pattern, style);
      const auto [first, is_new] = sewn.emplace(std::pair(side.panel, side.edge), stitch.item(k).path);
      if (!is_new)
        stitch.item(k).fail(
            fmt::format("edge {} of panel '{}' is sewn already, by {}; cut the edge in two, or remove "
                        "one of the stitches",
                        side.edge, pattern.panels[side.panel].name, first->second));
    }
    if (size == 3) {
      name_at(stitch.item(2), {"right_wrong"}, "kind of stitch");
      seam.direction = SeamDirection::start_to_start;
    }
    pattern.seams.push_back(seam);
  }
}

} // namespace

SewingPattern parse_pattern(const std::string& text, const std::string& file_name) {
  const bool is_json = file_name.ends_with(".json");
  const Tree tree = config::parse_document(text, file_name);
  if (tree.kind != Tree::Kind::map)
    throw InputError(tree.place + ": this is no sewing pattern; give a file with keys such as 'panels:'");
  const auto unknown = is_json ? UnknownKeys::passed_over : UnknownKeys::refused;
  const bool nested = tree.find("pattern");
  std::vector<std::string> keys{"panels", "stitches", "panel_order"};
  const std::vector<std::string> around{"properties", "parameters", "parameter_order"};
  std::vector<std::string> of_root = nested ? std::vector<std::string>{"pattern"} : keys;
  of_root.insert(of_root.end(), around.begin(), around.end());
  const PatternBlock root(tree, "pattern", of_root, unknown);
  const Properties properties = read_properties(root, is_json);
  const PatternBlock body = nested ? PatternBlock(root.at("pattern").tree, "pattern", keys, unknown) : root;
  SewingPattern pattern;
  pattern.name = file_name;
  const Spot panels = body.at("panels");
  if (panels.tree.entries.empty()) config::fail_type(panels, "panels by their names");
  for (const config::Entry& entry : panels.tree.entries)
    pattern.panels.push_back(read_panel(entry, properties));
  put_in_order(pattern.panels, body);
  if (body.has("stitches")) {
    const Spot spot = body.at("stitches");
    read_seams({spot.tree, "stitches", spot.key}, pattern, properties.style);
  }
  return pattern;
}

} // namespace taut::garment
