// Where panels are placed before they are sewn.
#include "src/garment/place_panels.hpp"
#include "tests/garment/patterns.hpp"

#include <gtest/gtest.h>

using namespace taut;
using namespace taut::garment;
using namespace taut::test;

namespace {

constexpr double apart = 0.01; // m

std::string at(double x, double y, double z) {
  std::ostringstream text;
  text << "    translation: [" << x << ", " << y << ", " << z << "]\n";
  return text.str();
}

std::vector<Vec3> places_of(const std::string& text) {
  std::vector<Vec3> places;
  for (const Panel& panel : place_panels(pattern_of(text), apart).panels) places.push_back(panel.translation);
  return places;
}

/// A yoke above a skirt that is wider, or not.
std::string yoke_and_skirt(double yoke, double skirt, double height, const std::string& turned = "") {
  return "panels:\n" + rectangle("yoke", yoke, 0.15, at(-yoke / 2, height, 0.05) + turned) +
         rectangle("skirt", skirt, 0.4, at(-skirt / 2, 0, 0.05)) +
         "stitches: [[{panel: yoke, edge: 0}, {panel: skirt, edge: 2}]]\n";
}

} // namespace

TEST(PlacePanels, CloseTheGapBetweenOneAboveTheOther) {
  const auto places = places_of("panels:\n" + rectangle("bodice", 0.2, 0.3, at(0, 0.5, 0.1)) +
                                rectangle("skirt", 0.2, 0.4, at(0, 0, 0.05)) +
                                "stitches: [[{panel: bodice, edge: 0}, {panel: skirt, edge: 2}]]\n");
  EXPECT_NEAR(places[0][1], places[1][1] + 0.4, 1e-12);
  EXPECT_NEAR(places[0][1] + places[1][1], 0.5, 1e-12); // each half the way
  EXPECT_EQ(places[0][2], 0.1);
}

// A skirt that is cut along an arc is lower in the middle: what counts is the mean along the seam.
TEST(PlacePanels, CloseTheGapInTheMeanAlongTheSeam) {
  const auto places = places_of("panels:\n" + rectangle("bodice", 0.2, 0.3, at(0, 0.5, 0.1)) +
                                "  skirt:\n    vertices: [[0, 0], [0.2, 0], [0.2, 0.4], [0, 0.4]]\n"
                                "    edges: [{endpoints: [0, 1]}, {endpoints: [1, 2]}, {endpoints: [2, 3], "
                                "curvature: [0.5, 0.5]}, {endpoints: [3, 0]}]\n"
                                "stitches: [[{panel: bodice, edge: 0}, {panel: skirt, edge: 2}]]\n");
  // Of a parabola the mean along x is two thirds of how deep it is, that along the arc is less.
  const double deep = 0.05;
  const double lower = places[1][1] + 0.4 - places[0][1];
  EXPECT_GT(lower, 0.5 * deep);
  EXPECT_LT(lower, 2.0 / 3.0 * deep);
}

TEST(PlacePanels, LeaveWhatIsAsHighAsEachOther) {
  const auto places = places_of("panels:\n" + rectangle("front", 0.2, 0.3, at(0, 0.1, 0.1)) +
                                rectangle("back", 0.2, 0.3, at(0, 0.2, -0.1)) +
                                "stitches: [[{panel: front, edge: 1}, {panel: back, edge: 3}]]\n");
  EXPECT_NEAR(places[0][1], 0.1, 1e-12);
  EXPECT_NEAR(places[1][1], 0.2, 1e-12);
}

TEST(PlacePanels, MoveApartWhatLiesOnEachOther) {
  const auto places =
      places_of("panels:\n" + rectangle("right", 0.2, 0.3, at(-0.195, 0, -0.1)) +
                rectangle("left", 0.2, 0.3, at(0, 0, -0.1)) + rectangle("front", 0.3, 0.3, at(-0.1, 0, 0.1)) +
                "stitches: [[{panel: right, edge: 1}, {panel: left, edge: 3}]]\n");
  EXPECT_EQ(places[0][2], -0.1);
  EXPECT_NEAR(places[1][2], -0.1 - apart, 1e-12); // away from the middle
  EXPECT_EQ(places[2][2], 0.1);
}

TEST(PlacePanels, LetThoseTouchThatAreSewnTogether) {
  const std::string beside = "panels:\n" + rectangle("right", 0.2, 0.3, at(-0.2, 0, -0.1)) +
                             rectangle("left", 0.2, 0.3, at(0, 0, -0.1));
  EXPECT_EQ(places_of(beside + "stitches: [[{panel: right, edge: 1}, {panel: left, edge: 3}]]\n")[1][2],
            -0.1);
  EXPECT_NE(places_of(beside)[1][2], -0.1);
}

// What is gathered is not where it belongs along the seam, so it would lie on what is beside that.
TEST(PlacePanels, MoveApartWhatTouchesAlongAGatheredSeam) {
  for (const double gap : {0.0, 0.03}) {
    const auto places = places_of(yoke_and_skirt(0.4, 0.588, 0.4 + gap));
    EXPECT_NEAR(places[0][1], places[1][1] + 0.4, 1e-12);
    EXPECT_EQ(places[0][2], 0.05);
    EXPECT_NEAR(std::abs(places[1][2] - 0.05), apart, 1e-12) << gap;
  }
  EXPECT_EQ(places_of(yoke_and_skirt(0.4, 0.4, 0.43))[1][2], 0.05);
}

TEST(PlacePanels, MoveApartWhatTouchesAtAnAngle) {
  const std::string turned = "    rotation: [20, 0, 0]\n";
  EXPECT_NEAR(std::abs(places_of(yoke_and_skirt(0.4, 0.588, 0.4, turned))[1][2] - 0.05), apart, 1e-12);
  EXPECT_EQ(places_of(yoke_and_skirt(0.4, 0.4, 0.4, turned))[1][2], 0.05);
}

// Beside a seam that is closed there may be a slit.
TEST(PlacePanels, MoveApartWhatTouchesBesideAClosedSeam) {
  const auto halves = [](const std::string& seams) {
    const std::string loop = "    edges: [{endpoints: [0, 1]}, {endpoints: [1, 2]}, {endpoints: [2, 3]}, "
                             "{endpoints: [3, 4]}, {endpoints: [4, 0]}]\n";
    const std::string right = "    vertices: [[0, 0], [0.2, 0], [0.2, 0.1], [0.2, 0.3], [0, 0.3]]\n";
    const std::string left = "    vertices: [[0, 0], [0.2, 0], [0.2, 0.3], [0, 0.3], [0, 0.1]]\n";
    return "panels:\n  right:\n" + right + loop + at(-0.2, 0, -0.1) + "  left:\n" + left + loop +
           at(0, 0, -0.1) + "stitches: [" + seams + "]\n";
  };
  const std::string upper = "[{panel: right, edge: 2}, {panel: left, edge: 3}]",
                    lower = "[{panel: right, edge: 1}, {panel: left, edge: 4}]";
  EXPECT_EQ(places_of(halves(upper + ", " + lower))[1][2], -0.1);
  EXPECT_NE(places_of(halves(upper))[1][2], -0.1);
}
