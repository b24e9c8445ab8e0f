// Sewing patterns: curves, the reader, and what it says to bad ones.
#include "tests/garment/patterns.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

using namespace taut;
using namespace taut::garment;
using namespace taut::test;
using testing::HasSubstr;
using testing::StartsWith;

namespace {

constexpr double pi = std::numbers::pi;

const Curve& first_curve(const SewingPattern& pattern) { return pattern.panels[0].edges[0].curve; }

SewingPattern panel_with(const std::string& curvature) { return pattern_of(curved(curvature)); }

std::string error_of_edge(const std::string& curvature) { return message_of(curved(curvature)); }

/// Arc length of y = 4 b x (1 - x) over [0, 1].
double parabola(double b) {
  const double a = 4 * b;
  return std::sqrt(1 + a * a) / 2 + std::asinh(a) / (2 * a);
}

} // namespace

TEST(Curves, LengthsAndAreasAreThoseOfAnalysis) {
  const auto quadratic = panel_with("{type: quadratic, params: [[0.5, -0.4]]}"); // y = -0.8 x (1 - x)
  EXPECT_NEAR(length_of(first_curve(quadratic)), parabola(0.2), 1e-12);
  EXPECT_NEAR(signed_area(quadratic.panels[0]), 0.8 / 6, 1e-14);

  const auto cubic =
      panel_with("{type: cubic, params: [[0, -1], [1, -1]]}"); // area 3/20 (.. of this one) = 0.6
  EXPECT_NEAR(signed_area(cubic.panels[0]), 0.6, 1e-14);

  const auto half = panel_with("{type: circle, params: [0.5, 0, 1]}"); // counter-clockwise: below the chord
  EXPECT_NEAR(length_of(first_curve(half)), pi / 2, 1e-12);
  EXPECT_NEAR(signed_area(half.panels[0]), pi / 8, 1e-12);
  const auto large = panel_with("{type: circle, params: [1, 1, 1]}"),
             small = panel_with("{type: circle, params: [1, 0, 0]}");
  EXPECT_NEAR(length_of(first_curve(large)), 2 * pi - pi / 3, 1e-12);
  EXPECT_NEAR(length_of(first_curve(small)), pi / 3, 1e-12);
  EXPECT_NEAR(signed_area(large.panels[0]), pi - (pi / 6 - std::sqrt(3) / 4), 1e-12);
  EXPECT_NEAR(signed_area(small.panels[0]), -(pi / 6 - std::sqrt(3) / 4), 1e-12);
}

TEST(Curves, PointsAreUniformInArcLength) {
  const std::vector<double> parts{0, 0.25, 0.5, 0.75, 1};
  for (const char* kind : {"{type: cubic, params: [[0.1, -1.5], [0.2, -0.1]]}",
                           "{type: circle, params: [0.7, 1, 1]}", "[0.9, -0.8]"}) {
    const auto pattern = panel_with(kind);
    const Curve& curve = first_curve(pattern);
    const auto points = points_along(curve, parts);
    EXPECT_EQ(points.front(), start_of(curve));
    EXPECT_EQ(points.back(), end_of(curve));
    std::vector<double> fine;
    for (int i = 0; i <= 4000; ++i) fine.push_back(i / 4000.0);
    const auto chain = points_along(curve, fine);
    double length = 0;
    for (std::size_t i = 1; i < chain.size(); ++i) {
      length += (chain[i] - chain[i - 1]).norm();
      if (i % 1000 == 0) {
        EXPECT_NEAR(length, double(i) / 4000 * length_of(curve), 1e-5) << kind;
        EXPECT_LT((chain[i] - points[i / 1000]).norm(), 1e-12);
      }
    }
  }
}

TEST(Reader, TakesUnitsPlacesAndProperties) {
  const std::string panel =
      "{translation: [100, 0, 50], rotation: [90, 0, 90], vertices: [[0, 0], [30, 0], [30, 20], "
      "[0, 20]], edges: [{endpoints: [0, 1], label: hem}, {endpoints: [1, 2]}, {endpoints: [2, "
      "3]}, {endpoints: [3, 0]}], label: null}";
  const auto pattern = parse_pattern("{\"pattern\": {\"panels\": {\"a\": " + panel +
                                         "}, \"other\": 1}, \"properties\": "
                                         "{\"units_in_meter\": 100, \"normalized_edge_loops\": true, "
                                         "\"normalize_panel_translation\": true}}",
                                     "a.json");
  const Panel& a = pattern.panels[0];
  EXPECT_NEAR(signed_area(a), 0.06, 1e-15);
  EXPECT_EQ(start_of(a.edges[0].curve), Vec2(-0.15, -0.1));
  EXPECT_LT((a.translation - Vec3(1.15, 0.1, 0.5)).norm(), 1e-15);
  // Rz Ry Rx: x stays in the plane of Rx, and is turned by Rz
  EXPECT_LT((a.rotation * Vec3(1, 0, 0) - Vec3(0, 1, 0)).norm(), 1e-15);
  EXPECT_LT((a.rotation * Vec3(0, 1, 0) - Vec3(0, 0, 1)).norm(), 1e-15);
  EXPECT_EQ(a.edges[0].label, "hem");
  EXPECT_EQ(a.label, "");
}

TEST(Reader, TakesTheOldFormOfCurvature) {
  const auto relative = panel_with("[0.5, -0.4]");
  EXPECT_NEAR(signed_area(relative.panels[0]), 0.8 / 6, 1e-14);
  const auto absolute = pattern_of("properties: {curvature_coords: absolute}\n" + curved("[0.5, -0.4]"));
  EXPECT_NEAR(signed_area(absolute.panels[0]), 0.8 / 6, 1e-14);
}

TEST(Reader, PutsPanelsInTheirOrderAndReadsStitches) {
  const auto pattern = pattern_of("panels:\n" + rectangle("a", 0.3, 0.2) + rectangle("b", 0.3, 0.2) +
                                  rectangle("c", 0.1, 10, "") +
                                  "panel_order: [c, a]\nstitches:\n"
                                  "  - [{panel: a, edge: 1}, {panel: b, edge: 3}]\n"
                                  "  - [{panel: a, edge: 0}, {panel: a, edge: 2}, right_wrong]\n");
  EXPECT_EQ(pattern.panels[0].name + pattern.panels[1].name + pattern.panels[2].name, "cab");
  EXPECT_EQ(name_of(pattern, pattern.seams[0]), "a.1-b.3");
  EXPECT_EQ(pattern.seams[0].direction, SeamDirection::start_to_end);
  EXPECT_EQ(pattern.seams[1].direction, SeamDirection::start_to_start);
  EXPECT_EQ(pattern.seams[1].sides[0], (SeamSide{1, 0}));
}

TEST(BadPattern, IsNamedWithPlaceAndCure) {
  const std::string square = "panels:\n" + rectangle("front", 0.3, 0.3);
  EXPECT_EQ(
      message_of(
          "panels: {a: {vertices: [[0, 0], [0.3, 0.3], [0.3, 0], [0, 0.3]], edges: [{endpoints: [0, 1]}, "
          "{endpoints: [1, 2]}, {endpoints: [2, 3]}, {endpoints: [3, 0]}]}}"),
      "shirt.yaml:1:10: panel 'a' crosses or touches itself: edges 0 and 2 meet at (0.1500, 0.1500) m in its "
      "plane; "
      "move their vertices, or lessen their curvature");
  EXPECT_EQ(
      message_of(
          "panels: {a: {vertices: [[0, 0], [0.3, 0], [0.2, 0]], edges: [{endpoints: [0, 1]}, {endpoints: "
          "[1, 2]}, {endpoints: [2, 0]}]}}"),
      "shirt.yaml:1:10: panel 'a' has no area: its edges lie on one line; correct its vertices");
  EXPECT_THAT(
      message_of(
          "panels: {a: {vertices: [[0, 0], [0.3, 0], [0.2, 1]], edges: [{endpoints: [0, 1]}, {endpoints: "
          "[1, 2]}]}}"),
      HasSubstr(
          "panels.a.edges.0: the outline is open: edge 0 begins at vertex 0, but edge 1 before it ends at "
          "vertex 2; the edges are one closed loop"));
  EXPECT_EQ(message_of("panels:\n" + rectangle("strap", 0.3, 0.005)),
            "shirt.yaml:2:3: panel 'strap' is thinner than an edge: nowhere wider than 5 mm, with edges of "
            "10 mm; give it "
            "shorter ones, e.g. edge: 2.5 mm");
  EXPECT_THAT(
      message_of("panels: {a: {vertices: [[0, 0], [0.3, 0], [0.3, 0.3], [0.151, 0.002], [0, 0.3]], edges: "
                 "[{endpoints: [0, 1]}, {endpoints: [1, 2]}, {endpoints: [2, 3]}, {endpoints: [3, 4]}, "
                 "{endpoints: [4, 0]}]}}"),
      StartsWith("shirt.yaml:1:10: panel 'a' is too narrow for edges of 10 mm at (0.15"));
  EXPECT_EQ(message_of("panels:\n" + rectangle("front", 40, 60)),
            "shirt.yaml:2:3: panel 'front' is 40 m by 60 m large; if the numbers of the pattern are "
            "centimetres, say so by "
            "properties: {units_in_meter: 100}");
  EXPECT_THAT(message_of(square + "    grian: 45\n"),
              HasSubstr("unknown key 'grian' (did you mean 'grain'?)"));
  EXPECT_THAT(message_of(square, 1e-6), HasSubstr("more than one rank can make"));
  EXPECT_THAT(message_of("[1, 2]"), StartsWith("shirt.yaml:1:1: this is no sewing pattern"));
  EXPECT_THAT(message_of("panels: {}"), HasSubstr("panels by their names"));
  EXPECT_THAT(message_of("{\"pattern\": {\"panels\": {}}}", 0.01, "a.json"),
              HasSubstr("normalized_edge_loops is missing: an old form"));
  EXPECT_THAT(message_of("properties: {normalized_edge_loops: false}\n" + square), HasSubstr("an old form"));
}

TEST(BadPattern, StitchesAreNamed) {
  const std::string two =
      "panels:\n" + rectangle("front", 0.3, 0.3) + rectangle("back", 0.3, 0.3) + "stitches:\n";
  EXPECT_EQ(message_of(two + "  - [{panel: front, edge: 0}, {panel: back, edge: 2}]\n"
                             "  - [{panel: back, edge: 1}, {panel: front, edge: 0}]\n"),
            "shirt.yaml:10:30: stitches.1.1: edge 0 of panel 'front' is sewn already, by stitches.0.0; cut "
            "the edge in "
            "two, or remove one of the stitches");
  EXPECT_EQ(message_of(two + "  - [{panel: fornt, edge: 0}, {panel: back, edge: 2}]\n"),
            "shirt.yaml:9:14: stitches.0.0.panel: there is no panel 'fornt' (did you mean 'front'?); there "
            "are front, back");
  EXPECT_EQ(message_of(two + "  - [{panel: front, edge: 4}, {panel: back, edge: 2}]\n"),
            "shirt.yaml:9:27: stitches.0.0.edge: there is no edge of panel 'front' with number 4; they go "
            "from 0 to 3");
  EXPECT_THAT(message_of(two + "  - [{panel: front, edge: 0}, {panel: back, edge: 2}, rihgt_wrong]\n"),
              HasSubstr("there is no kind of stitch 'rihgt_wrong' (did you mean 'right_wrong'?)"));
}

TEST(BadPattern, CurvatureOutOfRangeIsNamed) {
  EXPECT_THAT(
      error_of_edge("{type: circle, params: [0.4, 0, 1]}"),
      HasSubstr(
          "panels.a.edges.0.curvature.params.0: radius 0.4 m is out of range: the ends of the edge are 1 m "
          "apart; it must be at least half of that"));
  EXPECT_THAT(
      error_of_edge("{type: quadratic, params: [[0.5, 30]]}"),
      HasSubstr("control point [0.5, 30] is out of range: it lies more than 10 lengths of the edge away"));
  EXPECT_THAT(error_of_edge("{type: quadratic, params: [[0.5, .nan]]}"), HasSubstr("not a finite number"));
  EXPECT_THAT(error_of_edge("{type: spline, params: [[0.5, 1]]}"),
              HasSubstr("there is no type of curvature 'spline'"));
  EXPECT_THAT(error_of_edge("{type: cubic, params: [[0.5, 1]]}"), HasSubstr("control points"));
  EXPECT_THAT(error_of_edge("{type: cubic, params: [[2, -1], [-1, -1]]}"),
              HasSubstr("edge 0 meets itself at"));
}
