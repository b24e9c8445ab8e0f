// The mesh of a single panel: whole, conforming, without slivers, whatever its outline.
#include "src/garment/sharpness.hpp"
#include "src/garment/triangulation.hpp"
#include "tests/garment/patterns.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numbers>
#include <random>

using namespace taut;
using namespace taut::garment;
using namespace taut::test;

namespace {

constexpr double degree = std::numbers::pi / 180;

double cross(const Vec2& a, const Vec2& b) { return a[0] * b[1] - a[1] * b[0]; }

/// Every edge inside belongs to two cells, once in each direction; those of the border are one closed curve,
/// once around the panel; all corners turn left.
void expect_whole(const GarmentMesh& mesh, const std::string& what) {
  for (const MeshedPanel& panel : mesh.panels) {
    std::map<std::pair<Global, Global>, int> directed;
    double area = 0;
    for (Global c = panel.first_cell; c < panel.first_cell + panel.cells; ++c) {
      const Cell& cell = mesh.cells[c];
      for (int k = 0; k < cell.size(); ++k) {
        const auto at = [&](int i) { return mesh.material[cell.vertices[(k + i) % cell.size()]]; };
        ++directed[{cell.vertices[k], cell.vertices[(k + 1) % cell.size()]}];
        area += cross(at(0), at(1)) / 2;
        ASSERT_GT(cross(at(1) - at(0), at(2) - at(1)), 0) << what;
      }
    }
    std::size_t border = 0;
    std::vector<char> used(panel.vertices, 0);
    for (const auto& [edge, count] : directed) {
      ASSERT_EQ(count, 1) << what;
      used[edge.first - panel.first_vertex] = 1;
      if (directed.contains({edge.second, edge.first})) continue;
      ++border;
      const Global size = Global(panel.outline.points.size()), from = edge.first - panel.first_vertex;
      ASSERT_EQ(edge.second - panel.first_vertex, (from + 1) % size) << what;
    }
    EXPECT_EQ(border, panel.outline.points.size()) << what;
    EXPECT_EQ(std::ranges::count(used, 0), 0) << what;
    const Global edges = Global(directed.size() + border) / 2;
    EXPECT_EQ(panel.vertices - edges + panel.cells, 1) << what; // Euler: a disc
    double polygon = 0;
    const auto& p = panel.outline.points;
    for (std::size_t i = 0; i < p.size(); ++i) polygon += cross(p[i], p[(i + 1) % p.size()]) / 2;
    EXPECT_NEAR(area, std::abs(polygon), 1e-9) << what;
  }
}

/// The smallest angle inside an outline where edges of the pattern meet.
double sharpest_corner(const Outline& outline) {
  const auto& p = outline.points;
  const auto n = int(p.size());
  double area = 0, smallest = 10;
  for (int i = 0; i < n; ++i) area += cross(p[i], p[(i + 1) % n]);
  for (const int c : outline.first) {
    const Vec2 on = p[(c + 1) % n] - p[c], back = p[(c + n - 1) % n] - p[c];
    const double angle = std::atan2(area > 0 ? cross(on, back) : cross(back, on), on.dot(back));
    if (angle > 0) smallest = std::min(smallest, angle);
  }
  return smallest;
}

bool cross_inside(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  const auto side = [](const Vec2& p, const Vec2& q, const Vec2& r) { return cross(q - p, r - p); };
  return side(a, b, c) * side(a, b, d) < 0 && side(c, d, a) * side(c, d, b) < 0;
}

/// A polygon through random points that does not cross itself, its sides bent, some of them sewn together,
/// with necks and corners however sharp.
SewingPattern random_pattern(unsigned seed) {
  std::mt19937 random(seed);
  const auto number = [&](double low, double high) {
    return low + (high - low) * (double(random()) / 4294967296.0);
  };
  std::vector<Vec2> corners(std::size_t(number(3, 16)));
  for (Vec2& c : corners) c = {number(0, 1), number(0, 1)};
  const std::size_t n = corners.size();
  for (bool changed = true; changed;) {
    changed = false;
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = i + 2; j < n; ++j)
        if (cross_inside(corners[i], corners[i + 1], corners[j], corners[(j + 1) % n])) {
          std::reverse(corners.begin() + long(i) + 1, corners.begin() + long(j) + 1);
          changed = true;
        }
  }
  const double bend = std::max(0.0, number(-0.3, 0.3));
  Panel panel;
  panel.name = "random";
  panel.grain = std::max(0.0, number(-1, 1));
  for (std::size_t i = 0; i < n; ++i) {
    const Vec2 a = corners[i], b = corners[(i + 1) % n], run = b - a;
    panel.edges.push_back(
        {quadratic(a, (a + b) / 2 + bend * number(-1, 1) * Vec2(-run[1], run[0]), b), "", ""});
  }
  SewingPattern pattern{"random", {panel}, {}};
  for (std::size_t i = 0; i + 1 < n; i += 2)
    if (number(0, 1) < 0.5) {
      const double ratio = length_of(panel.edges[i].curve) / length_of(panel.edges[i + 1].curve);
      if (ratio < 3 && ratio > 0.33)
        pattern.seams.push_back({{{{0, int(i)}, {0, int(i) + 1}}}, SeamDirection(random() % 2), ""});
    }
  return pattern;
}

} // namespace

TEST(PanelMesh, FillsARectangleWithSquares) {
  const auto mesh = mesh_garment(pattern_of("panels:\n" + rectangle("a", 0.5, 0.4)), {0.02, {}});
  expect_whole(mesh, "rectangle");
  EXPECT_EQ(mesh.panels[0].cells - mesh.panels[0].triangles, 23 * 18);
  EXPECT_GT(mesh.panels[0].sharpest.angle, 40 * degree);
}

TEST(PanelMesh, HasNoSliversWhereSegmentsDiffer) {
  for (const double own : {0.002, 0.005, 0.03}) {
    const std::string text = "panels:\n" + rectangle("a", 0.3, 0.3) +
                             rectangle("b", 0.3, 0.3, "    edge: " + std::to_string(own) + "\n") +
                             "stitches:\n  - [{panel: a, edge: 1}, {panel: b, edge: 3}]\n";
    const auto mesh = mesh_garment(pattern_of(text), {0.01, {}});
    expect_whole(mesh, text);
    for (const auto& panel : mesh.panels) EXPECT_GT(panel.sharpest.angle, 20 * degree) << own << panel.name;
  }
}

TEST(PanelMesh, GoesAroundTinyEdges) {
  for (const double tiny : {3e-3, 1e-3, 1e-4, 1e-5}) {
    const std::string t = std::to_string(tiny);
    const std::string text =
        "panels: {a: {vertices: [[0, 0], [0.3, 0], [0.3, 0.2], [" + std::to_string(0.3 - tiny) +
        ", 0.2], [0, 0.25]], edges: [{endpoints: [0, 1]}, {endpoints: [1, 2]}, {endpoints: [2, 3]}, "
        "{endpoints: [3, 4]}, {endpoints: [4, 0]}]}}";
    const auto mesh = mesh_garment(pattern_of(text), {0.01, {}});
    expect_whole(mesh, t);
    EXPECT_GT(mesh.panels[0].sharpest.angle, 20 * degree) << t;
  }
}

TEST(PanelMesh, SharpCornersStayTheOnlySharpPlaces) {
  for (const double half : {0.02, 0.05, 0.1}) {
    const std::string h = std::to_string(half);
    const std::string text = "panels: {a: {vertices: [[0, 0], [1, -" + h + "], [1, " + h +
                             "]], edges: [{endpoints: [0, 1]}, {endpoints: [1, 2]}, {endpoints: [2, 0]}]}}";
    const auto mesh = mesh_garment(pattern_of(text), {0.01, {}});
    expect_whole(mesh, h);
    EXPECT_GT(mesh.panels[0].sharpest.angle, std::min(15 * degree, 1.9 * std::atan(half))) << h;
  }
}

TEST(PanelMesh, OfRandomPanelsIsWholeOrRefused) {
  int meshed = 0, refused = 0;
  for (unsigned seed = 0; seed < 1000; ++seed) {
    SewingPattern pattern = random_pattern(seed);
    try {
      check_panels(pattern);
    } catch (const InputError&) {
      continue; // bent sides may cross
    }
    try {
      const auto mesh = mesh_garment(pattern, {0.006 + 0.0001 * (seed % 400), {}});
      expect_whole(mesh, std::to_string(seed));
      EXPECT_GT(mesh.panels[0].sharpest.angle,
                std::min(15 * degree, sharpest_corner(mesh.panels[0].outline) / 2))
          << seed;
      ++meshed;
    } catch (const InputError& error) {
      EXPECT_TRUE(std::string(error.what()).find("narrow") != std::string::npos ||
                  std::string(error.what()).find("thinner") != std::string::npos)
          << seed << error.what();
      ++refused;
    }
  }
  EXPECT_GT(meshed, 20 * refused);
}
