// Obstacles that are made of others, or turn.
#include "src/contact/union_mesh.hpp"
#include "src/output/intersection_check.hpp"
#include "tests/simulate.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <map>

namespace taut::test {
namespace {

constexpr double degree = 0.017453292519943295;

/// How a patch moves on a plane that tilts.
struct Ride {
  double crept;        ///< m down the plane while it tilts
  double acceleration; ///< m/s^2 down the plane once that rests
  double farthest;     ///< m of any vertex from the thickness above the plane, then
  Global intersections;
};

constexpr auto plane = "plane: {reach: 0.5}";
constexpr auto box = "box: {min: [-0.5, -0.45, -0.2], max: [0.5, 0.5, 0]}";

/// A patch of 10 cm on an obstacle that turns by `angle` (rad) within 0.3 s about an axis beside the patch,
/// which so goes down with it, and then rests for 0.2 s.
Ride ride(std::string_view obstacle, double angle, double friction) {
  const double thickness = 1e-3, end = 0.5;
  const Case input = case_of(fmt::format("cloth:\n"
                                         "  grid: {{size: [0.1, 0.1], vertices: [9, 9]}}\n"
                                         "  start: {{translate: [-0.05, -0.05, {}]}}\n"
                                         "obstacles:\n"
                                         "  - {}\n"
                                         "    motion: [{{time: 0}}, {{time: 0.3, rotate: {{axis: [0, 1, 0], "
                                         "angle: {}, centre: [-0.1, 0, 0]}}}}]\n"
                                         "    friction: {}\n"
                                         "contact: {{thickness: {}, check: step}}\n"
                                         "time: {{end: {}, frame_rate: 10, max_step: 0.0025}}\n",
                                         thickness, obstacle, angle, friction, thickness, end));
  Simulation simulation(world, input);
  IntersectionCheck check(simulation.cloth(), simulation.obstacles(), input);
  Recorder record(simulation);
  Observer* const observers[] = {&record, &check};
  const Outcome outcome = simulation.run(observers);
  EXPECT_TRUE(outcome.completed()) << outcome.reason;
  const Obstacles& body = simulation.obstacles();
  std::vector<double> times{0}, places; // of the patch's middle, down the plane
  double farthest = 0;
  for (const StepRecord& r : record.records) times.push_back(times.back() + r.dt);
  for (std::size_t k = 0; k < times.size(); ++k) {
    const auto x = record.positions[k].reshaped(3, 81);
    const Vec3 origin = body.moved(0, Vec3::Zero(), times[k]);
    const Mat3 turned = body.turned(0, 0, times[k]);
    places.push_back(turned.col(0).dot(x.rowwise().mean() - origin));
    for (Global i = 0; i < 81 && times[k] >= 0.35; ++i)
      farthest = std::max(farthest, std::abs(turned.col(2).dot(x.col(i) - origin) - thickness));
  }
  const auto at = [&](double time) {
    return std::size_t(std::lower_bound(times.begin(), times.end(), time - 1e-9) - times.begin());
  };
  const auto speed = [&](std::size_t k) { return (places[k] - places[k - 1]) / (times[k] - times[k - 1]); };
  const std::size_t first = at(0.35), last = times.size() - 1;
  return {places[at(0.3)] - places[0], (speed(last) - speed(first)) / (times[last] - times[first]), farthest,
          check.count()};
}

TEST(TurningPlane, HoldsAPatchBelowCoulombsAngle) {
  const Ride r = ride(plane, std::atan(0.5) - 3 * degree, 0.5);
  EXPECT_LT(std::abs(r.crept), 5e-4);
  EXPECT_LT(std::abs(r.acceleration), 0.02);
  EXPECT_EQ(r.intersections, 0);
}

void expect_to_slide_as_coulomb_says(std::string_view obstacle) {
  for (const auto& [angle, friction] : {std::pair{30 * degree, 0.3}, {20 * degree, 0.0}}) {
    const double expected = 9.81 * (std::sin(angle) - friction * std::cos(angle));
    const Ride r = ride(obstacle, angle, friction);
    EXPECT_NEAR(r.acceleration, expected, 0.005 * expected + 0.01 * friction * 9.81 * std::cos(angle));
    EXPECT_LT(r.farthest, 5e-5);
    EXPECT_EQ(r.intersections, 0);
  }
}

TEST(TurningPlane, LetsItSlideAboveAsCoulombSays) { expect_to_slide_as_coulomb_says(plane); }

/// Over the diagonal of the side, which vertices of the cloth pass by more than its thickness in a step.
TEST(Box, LetsClothSlideOverEdgesInsideItsSides) { expect_to_slide_as_coulomb_says(box); }

config::Union two_balls(double apart, double blend) {
  config::Union u;
  for (const double x : {-0.5, 0.5}) u.parts.push_back({config::Sphere{Vec3(x * apart, 0, 0), 0.1}, {}, {}});
  u.blend = blend;
  u.edge = 0.02;
  return u;
}

config::Union bulky() {
  config::Union u = two_balls(0.12, 0.03);
  u.parts.push_back({{}, config::Capsule{Vec3(0, -0.3, 0), Vec3(0.1, 0.3, 0.1), 0.06}, {}});
  u.parts.push_back({{}, {}, config::Box{Vec3(-0.2, -0.2, -0.2), Vec3(0.1, 0.1, -0.1)}});
  return u;
}

/// Its volume by the divergence theorem, m^3.
double volume(const UnionMesh& mesh) {
  double six = 0;
  for (const auto& [a, b, c] : mesh.triangles)
    six += mesh.positions[a].dot(mesh.positions[b].cross(mesh.positions[c]));
  return six / 6;
}

/// Every edge has two triangles, which run along it in opposite directions, and the triangles around every
/// vertex are one fan. Returns Euler's number: 2 for each surface without handles.
int euler_number_of_closed(const UnionMesh& mesh) {
  std::map<std::pair<Local, Local>, int> edges; // with direction
  std::vector<std::map<Local, Local>> around(mesh.positions.size());
  for (const auto& t : mesh.triangles)
    for (int k = 0; k < 3; ++k) {
      ++edges[{t[k], t[(k + 1) % 3]}];
      around[t[k]][t[(k + 1) % 3]] = t[(k + 2) % 3];
    }
  for (const auto& [edge, count] : edges) {
    EXPECT_EQ(count, 1);
    EXPECT_TRUE(edges.contains({edge.second, edge.first}));
  }
  for (const auto& fan : around) {
    std::size_t steps = 0;
    Local at = fan.begin()->first;
    do at = fan.at(at), ++steps;
    while (at != fan.begin()->first && steps <= fan.size());
    EXPECT_EQ(steps, fan.size());
  }
  return int(mesh.positions.size()) - int(edges.size()) / 2 + int(mesh.triangles.size());
}

TEST(UnionMesh, IsClosedAndLiesOnTheSurface) {
  for (const auto& [input, euler] : {std::pair{two_balls(0.12, 0.0), 2},
                                     {two_balls(0.12, 0.03), 2},
                                     {two_balls(0.3, 0.03), 4},
                                     {two_balls(0.21, 0.05), 2},
                                     {bulky(), 2}}) {
    const UnionMesh mesh = mesh_union(input);
    EXPECT_EQ(euler_number_of_closed(mesh), euler);
    const UnionDistance distance(input);
    double farthest = 0, longest = 0, shortest = HUGE_VAL, sum = 0;
    for (const Vec3& x : mesh.positions) farthest = std::max(farthest, std::abs(distance.at(x).distance));
    for (const auto& t : mesh.triangles)
      for (int k = 0; k < 3; ++k) {
        const double l = (mesh.positions[t[k]] - mesh.positions[t[(k + 1) % 3]]).norm();
        longest = std::max(longest, l), shortest = std::min(shortest, l), sum += l;
      }
    const double mean = sum / double(3 * mesh.triangles.size());
    EXPECT_LT(farthest, 1e-6);
    EXPECT_NEAR(mean, input.edge, 0.25 * input.edge);
    EXPECT_GT(shortest, 0.1 * input.edge);
    EXPECT_LT(longest, 2.5 * input.edge);
  }
}

TEST(UnionMesh, OfTwoBallsHasTheirVolume) {
  config::Union input = two_balls(0.12, 0.0);
  const double r = 0.1, cap = r - 0.06, pi = std::acos(-1.0);
  const double expected = 2 * (4 * pi / 3 * r * r * r - pi * cap * cap * (3 * r - cap) / 3);
  double last = HUGE_VAL;
  for (const double edge : {0.02, 0.01, 0.005}) { // of second order
    input.edge = edge;
    const double error = std::abs(volume(mesh_union(input)) / expected - 1);
    EXPECT_LT(error, std::min(0.03, 0.4 * last));
    last = error;
  }
}

/// On the plane half-way between two balls the fillet is narrowest: there r - d = r / sqrt(2) for both.
TEST(UnionMesh, IsBlendedWithTheRadiusAsked) {
  const config::Union input = two_balls(0.12, 0.03);
  const double distance = 0.03 * (1 - std::sqrt(0.5)),
               waist = std::sqrt(std::pow(0.1 + distance, 2) - 0.06 * 0.06);
  EXPECT_NEAR(UnionDistance(input).at({0, waist, 0}).distance, 0, 1e-12);
  const UnionMesh mesh = mesh_union(input);
  double narrowest = HUGE_VAL;
  for (const Vec3& x : mesh.positions)
    if (std::abs(x[0]) < 0.2 * input.edge) narrowest = std::min(narrowest, std::hypot(x[1], x[2]));
  EXPECT_NEAR(narrowest, waist, 0.02 * waist);
}

TEST(UnionDistance, HasTheGradientOfItsDifferences) {
  const config::Union input = bulky();
  const UnionDistance distance(input);
  for (const Vec3& x : random_vectors(200, 0.35, 3)) {
    const auto [d, gradient] = distance.at(x);
    const double h = 1e-7;
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(
          (distance.at(x + h * Vec3::Unit(k)).distance - distance.at(x - h * Vec3::Unit(k)).distance) /
              (2 * h),
          gradient[k], 1e-6);
  }
}

constexpr const char* joined_scene =
    "cloth: {grid: {size: [0.5, 0.5], vertices: [26, 26]}, start: {translate: [-0.25, -0.25, 0.14]}}\n"
    "obstacles:\n"
    "  - union:\n"
    "      parts:\n"
    "        - sphere: {centre: [-0.1, 0, 0], radius: 10 cm}\n"
    "        - capsule: {from: [0.1, -0.15, 0], to: [0.1, 0.15, 0], radius: 8 cm}\n"
    "        - box: {min: [-0.1, -0.1, -0.2], max: [0.1, 0.1, 0]}\n"
    "      blend: 3 cm\n"
    "      edge: 2 cm\n"
    "    motion: [{time: 0}, {time: 0.2, translate: [0, 0, 0.02], rotate: {axis: [0, 0, 1], angle: 0.3}}]\n"
    "contact: {thickness: 2 mm, check: step}\n"
    "time: {end: 0.25, frame_rate: 20, max_step: 0.005}\n";

TEST(UnionObstacle, IsTheSameOnAllRanksAndMovesOnKeyframes) {
  const Case input = case_of(joined_scene);
  const Obstacles obstacles(world, input);
  const UnionMesh mesh = mesh_union(*input.obstacles[0].joined);
  ASSERT_EQ(obstacles.vertices(), Local(mesh.positions.size()));
  EXPECT_TRUE(std::equal(mesh.positions.begin(), mesh.positions.end(), obstacles.start().begin()));
  EXPECT_EQ(obstacles.elements().size(), mesh.triangles.size());
  EXPECT_EQ(obstacles.body(0).rims, 0);
  EXPECT_EQ(obstacles.body(0).name, "obstacles.0 (union)");
  std::vector<Vec3> at;
  obstacles.place(0.1, at);
  const Eigen::AngleAxisd turn(0.15, Vec3::UnitZ());
  for (std::size_t i = 0; i < at.size(); ++i)
    EXPECT_LT((at[i] - (turn * mesh.positions[i] + Vec3(0, 0, 0.01))).norm(), 1e-12);
}

TEST(UnionObstacle, CatchesCloth) {
  const Case input = case_of(joined_scene);
  Simulation simulation(world, input);
  IntersectionCheck check(simulation.cloth(), simulation.obstacles(), input);
  Recorder record(simulation);
  Observer* const observers[] = {&record, &check};
  const Outcome outcome = simulation.run(observers);
  EXPECT_TRUE(outcome.completed()) << outcome.reason;
  EXPECT_EQ(check.count(), 0) << check.first();
  const auto x = record.positions.back().reshaped(3, 676);
  EXPECT_GT(x.row(2).maxCoeff(), 0.11); // on top of it
  EXPECT_LT(x.row(2).minCoeff(), 0.05); // and down at its sides
}

} // namespace
} // namespace taut::test
