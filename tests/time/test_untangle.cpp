// Starts that intersect, worked free before the first step.
#include "src/time/untangle.hpp"

#include "src/contact/intersections.hpp"
#include "tests/folder.hpp"
#include "tests/simulate.hpp"

#include <fmt/format.h>

#include <fstream>

using namespace taut;
using namespace taut::test;

namespace {

const std::string sheet = "grid: {size: [0.3, 0.3], vertices: [31, 31]}";
const std::string rest =
    "\ncontact: {start: untangle, check: step}\ntime: {end: 0.02, frame_rate: 50, max_step: 2 ms}\n";

Global intersections(const Simulation& simulation, const State& state) {
  std::vector<Vec3> bodies;
  simulation.obstacles().place(state.time, bodies);
  Intersections test(simulation.cloth(), simulation.obstacles());
  return sum_over(world, Global(test.find(state.positions, bodies).size()));
}

/// The start can be untangled by moves of at most `most` m, and the run that begins there is sound.
void expect_untangled(const Case& input, double most) {
  Simulation simulation(world, input);
  ASSERT_GT(intersections(simulation, simulation.state()), 0);
  const Untangled untangled = untangle(simulation, input);
  ASSERT_TRUE(untangled.succeeded()) << untangled.left << " left, strain " << untangled.strain;
  EXPECT_EQ(intersections(simulation, untangled.state), 0);
  EXPECT_LE(simulation.gauge().measure(untangled.state.positions).max, *simulation.strain_limit());
  EXPECT_LT(untangled.farthest, most);
  EXPECT_GT(untangled.farthest, 0.001);
  simulation.set_start(untangled.state);
  Recorder recorder(simulation);
  run_to_the_end(simulation, recorder);
  EXPECT_EQ(intersections(simulation, simulation.state()), 0);
  double speed = 0;
  for (const Vec3& v : simulation.state().velocities) speed = std::max(speed, v.norm());
  EXPECT_LT(max_over(world, speed), 1.0); // free fall: 0.2
}

void write_sheet(const std::filesystem::path& file, const std::function<double(double, double)>& height) {
  if (rank_of(world) == 0) {
    std::ofstream out(file);
    for (int i = 0; i < 31; ++i)
      for (int j = 0; j < 31; ++j)
        out << fmt::format("v {} {} {}\n", 0.01 * j, 0.01 * i, height(0.01 * j, 0.01 * i));
  }
  MPI_Barrier(world);
}

} // namespace

TEST(Untangle, OutOfASphere) {
  expect_untangled(case_of("cloth: {" + sheet +
                           "}\nobstacles: [{sphere: {centre: [0.15, 0.15, -0.097], radius: 0.1}}]" + rest),
                   0.006);
}

TEST(Untangle, FromBehindAPlaneWithPins) {
  expect_untangled(
      case_of("cloth: {" + sheet +
              ", start: {rotate: {axis: [1, 0, 0], angle: 0.01}, translate: [0, 0, "
              "-0.0015]}}\npins: [{near: [[0, 0.3, 0], [0.3, 0.3, 0]]}]\nobstacles: [{plane: {}}]" +
              rest),
      0.004);
}

TEST(Untangle, OffAMeshThatPokesThrough) {
  const Folder folder;
  if (rank_of(world) == 0)
    std::ofstream(folder / "pyramid.obj")
        << "v 0.1 0.1 -0.03\nv 0.2 0.1 -0.03\nv 0.2 0.2 -0.03\nv 0.1 0.2 -0.03\n"
           "v 0.152 0.153 0.003\nf 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\nf 4 3 2 1\n";
  MPI_Barrier(world);
  expect_untangled(case_of("cloth: {" + sheet + "}\nobstacles: [{mesh: " + (folder / "pyramid.obj").string() +
                           "}]" + rest),
                   0.01);
}

TEST(Untangle, OffABoxWithUprightWalls) {
  expect_untangled(case_of("cloth: {" + sheet +
                           "}\nobstacles: [{box: {min: [0.103, 0.106, -0.1], max: [0.204, 0.2015, 0.003]}}]" +
                           rest),
                   0.01);
}

TEST(Untangle, OffAnOpenMesh) {
  const Folder folder;
  if (rank_of(world) == 0)
    std::ofstream(folder / "roof.obj")
        << "v 0.1 0.1 -0.03\nv 0.2 0.1 -0.03\nv 0.2 0.2 -0.03\nv 0.1 0.2 -0.03\n"
           "v 0.152 0.153 0.003\nf 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\n";
  MPI_Barrier(world);
  expect_untangled(
      case_of("cloth: {" + sheet + "}\nobstacles: [{mesh: " + (folder / "roof.obj").string() + "}]" + rest),
      0.01);
}

TEST(Untangle, ADimpleThroughAnotherLayer) {
  const Folder folder;
  write_sheet(folder / "dimple.obj", [](double x, double y) {
    const double r2 = (x - 0.15) * (x - 0.15) + (y - 0.16) * (y - 0.16);
    return 0.004 - 0.007 * std::exp(-r2 / 0.0016);
  });
  expect_untangled(case_of("cloths: [{" + sheet + "}, {" + sheet +
                           ", start: {shape: " + (folder / "dimple.obj").string() + "}}]" + rest),
                   0.01);
}

TEST(Untangle, ACornerThroughAnotherLayer) {
  expect_untangled(
      case_of("cloths: [{" + sheet + "}, {" + sheet +
              ", start: {rotate: {axis: [1, -1, 0], angle: 0.08}, translate: [0.053, 0.057, -0.003]}}]" +
              rest),
      0.02);
}

TEST(Untangle, WhatDoesNotIntersectStaysWhereItIs) {
  const Case input = case_of("cloth: {" + sheet + "}\nobstacles: [{plane: {point: [0, 0, -0.1]}}]" + rest);
  Simulation simulation(world, input);
  const Untangled untangled = untangle(simulation, input);
  EXPECT_TRUE(untangled.succeeded());
  EXPECT_EQ(untangled.rounds, 0);
  EXPECT_EQ(untangled.state.positions, simulation.state().positions);
}

TEST(Untangle, SaysWhatIsHopeless) {
  // one cloth stands in the middle of another
  const Case input = case_of(
      "cloths: [{" + sheet + "}, {" + sheet +
      ", start: {rotate: {axis: [1, 0, 0], angle: 90 deg}, translate: [0.003, 0.147, -0.15]}}]" + rest);
  Simulation simulation(world, input);
  const Untangled untangled = untangle(simulation, input);
  EXPECT_FALSE(untangled.succeeded());
  EXPECT_GT(untangled.left, 0);
}
