// Bodies that are slim while a garment is sewn around them, and give way where cloth would be pinched.
#include "src/contact/slim_body.hpp"
#include "src/contact/union_mesh.hpp"
#include "src/contact/yielding_body.hpp"
#include "tests/simulate.hpp"

namespace taut::test {
namespace {

config::Solid capsule(const Vec3& from, const Vec3& to, double radius) {
  return {{}, config::Capsule{from, to, radius}, {}};
}

std::vector<Vec3> moved(const UnionMesh& mesh, const std::vector<Vec3>& ways) {
  std::vector<Vec3> places = mesh.positions;
  for (std::size_t v = 0; v < places.size(); ++v) places[v] += ways[v];
  return places;
}

/// Of those within `part` of the middle, the largest distance from the z axis.
double widest(const std::vector<Vec3>& places, double part) {
  double widest = 0;
  for (const Vec3& p : places)
    if (std::abs(p[2]) < part) widest = std::max(widest, p.head<2>().norm());
  return widest;
}

double highest(const std::vector<Vec3>& places) {
  double highest = 0;
  for (const Vec3& p : places) highest = std::max(highest, p[2]);
  return highest;
}

TEST(SlimBody, IsCloseToTheAxisOfALimbAndHardlyShorter) {
  const UnionMesh limb = mesh_union({{capsule({0, 0, -0.2}, {0, 0, 0.2}, 0.05)}, 0, 0.012});
  const auto slim = moved(limb, ways_to_slim(world, limb.positions, limb.triangles));
  EXPECT_LT(widest(slim, 0.15), 0.15 * 0.05);
  EXPECT_GT(highest(slim), 0.17);
  UnionMesh turned = limb;
  for (auto& t : turned.triangles) std::swap(t[1], t[2]);
  EXPECT_EQ(moved(turned, ways_to_slim(world, turned.positions, turned.triangles)), slim);
}

TEST(YieldingBody, LeavesRoomBetweenLimbsAndNothingElseMoves) {
  constexpr double gap = 0.004, room = 0.01, radius = 0.03, off = radius + 0.5 * gap;
  const UnionMesh limbs = mesh_union(
      {{capsule({off, 0, -0.1}, {off, 0, 0.1}, radius), capsule({-off, 0, -0.1}, {-off, 0, 0.1}, radius)},
       0,
       0.004});
  const auto places = moved(limbs, ways_to_room(limbs.positions, limbs.triangles, room));
  double between = HUGE_VAL, outer = 0;
  for (std::size_t v = 0; v < places.size(); ++v) {
    if (std::abs(places[v][2]) < 0.08) between = std::min(between, std::abs(places[v][0]));
    if (std::abs(places[v][0]) > off) outer = std::max(outer, (places[v] - limbs.positions[v]).norm());
  }
  EXPECT_GT(between, 0.3 * room); // of gap/2, where normals are worst
  EXPECT_EQ(outer, 0);
}

/// The largest way of two limbs that meet at an angle (rad).
double most_that_yields(double angle) {
  const Vec3 ends{0.1 * std::cos(angle), 0.1 * std::sin(angle), 0};
  const UnionMesh limbs =
      mesh_union({{capsule({0, 0, 0}, {0.1, 0, 0}, 0.02), capsule({0, 0, 0}, ends, 0.02)}, 0, 0.004});
  double most = 0;
  for (const Vec3& way : ways_to_room(limbs.positions, limbs.triangles, 0.01))
    most = std::max(most, way.norm());
  return most;
}

TEST(YieldingBody, LeavesRoomInArmpitsButNotInCreasesThatClothLiesOver) {
  EXPECT_GT(most_that_yields(0.25 * M_PI), 0.002);
  EXPECT_EQ(most_that_yields(0.55 * M_PI), 0);
}

} // namespace
} // namespace taut::test
