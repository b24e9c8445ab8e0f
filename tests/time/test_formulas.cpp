// Formulas that single terms of a step must follow, and what lasts from step to step.
#include "src/contact/rows.hpp"
#include "src/contact/thickness.hpp"
#include "src/forces/air_drag.hpp"
#include "src/state/start.hpp"
#include "src/time/acceptance.hpp"
#include "tests/simulate.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

using namespace taut;
using namespace taut::test;

namespace {

constexpr double g = 9.81; // m/s^2

Vec3 vertex(const Column& positions, int v) { return positions.segment<3>(3 * v); }

} // namespace

// Half the mass of the edge hangs on it. To first order in the strain: tension turns with the squared length.
TEST(HangingEdge, IsStrainedByComplianceTimesTension) {
  constexpr double compliance = 2e-3, tension = 0.5 * 0.2 * g;
  for (const std::string method : {"fast_projection", "shake", "icd"}) {
    Simulation simulation(
        world,
        case_of(fmt::format("cloth: {{line: {{length: 1, vertices: 2}}, start: {{rotate: {{axis: [0, 1, 0], "
                            "angle: 90 deg}}}}, material: {{density: 0.2}}}}\n"
                            "pins: [{{vertices: [0]}}]\n"
                            "time: {{end: 1, frame_rate: 1, max_step: 0.01}}\n"
                            "inextensibility: {{method: {}, compliance: {}}}\n",
                            method, compliance)));
    Recorder recorder(simulation);
    run_to_the_end(simulation, recorder);
    EXPECT_NEAR(vertex(recorder.positions.back(), 1).norm() - 1, compliance * tension,
                2 * compliance * tension * compliance * tension)
        << method;
  }
}

// Blocks along yarns are the whole matrix of a chain: wherever ranks cut it, the factor leaves nothing to
// iterate for.
TEST(YarnFactor, IsExactAcrossRanks) {
  Simulation simulation(world, case_of("cloth: {line: {length: 1, vertices: 60}}\n"
                                       "pins: [{vertices: [0]}]\n"
                                       "time: {end: 0.1, frame_rate: 10, max_step: 0.01}\n"
                                       "inextensibility: {method: fast_projection, strain: 1e-4}\n"));
  Recorder recorder(simulation);
  run_to_the_end(simulation, recorder);
  Global projections = 0, iterations = 0;
  for (const StepRecord& r : recorder.records) {
    projections += r.counts.iterations;
    iterations += r.counts.linear_iterations;
  }
  EXPECT_GT(projections, 10);
  EXPECT_LE(iterations, projections);
}

TEST(MassDamping, SlowsDownAsItsRateSays) {
  constexpr double rate = 3, h = 0.01;
  const auto implicit = [](double speed) { return (speed + h * g) / (1 + h * rate); };
  const auto of_xpbd = [](double speed) { return speed + h * (g - rate * speed); };
  const auto expect = [](const std::string& solver, const auto& next) {
    Simulation simulation(
        world, case_of("cloth: {grid: {size: [1, 1], vertices: [4, 4]}, material: {damping: {mass: 3}}}\n"
                       "time: {end: 0.1, frame_rate: 10, max_step: 0.01}\n" +
                       solver));
    Recorder recorder(simulation);
    run_to_the_end(simulation, recorder);
    ASSERT_EQ(recorder.records.size(), 10u);
    double speed = 0, z = 0;
    for (std::size_t step = 1; step <= 10; ++step) {
      speed = next(speed);
      z -= h * speed;
      for (const int v : {0, 7, 15})
        EXPECT_NEAR(vertex(recorder.positions[step], v).z(), z, 1e-4 * std::abs(z)); // what CG leaves
    }
  };
  expect("", implicit);
  expect("inextensibility: {method: xpbd, xpbd: {substeps: 1}}\n", of_xpbd);
}

TEST(Gust, TravelsWithTheWind) {
  const Cloth cloth = load_cloth(world, case_of("cloth: {grid: {size: [1, 1], vertices: [4, 4]}}\n"));
  const config::Air air{.wind = {0, 4, 3}, .gust = {.speed = 2, .length = 0.5, .period = 0.2}};
  const AirDrag drag(cloth, air);
  const Vec3 along(0, 0.8, 0.6);
  EXPECT_LT((drag.wind_at(along * 0.125, 0) - (air.wind + 2 * along)).norm(), 1e-12)
      << "a quarter of its length on";
  for (const double t : {0.01, 0.07, 0.15})
    EXPECT_LT((drag.wind_at(along * (0.1 + 0.5 * t / 0.2), t) - drag.wind_at(along * 0.1, 0)).norm(), 1e-12);
}

TEST(Pins, LetGoAtTheirRelease) {
  Simulation simulation(world, case_of("cloth: {line: {length: 1, vertices: 3}}\n"
                                       "pins: [{vertices: [0]}, {vertices: [2], release: 0.05}]\n"
                                       "time: {end: 0.1, frame_rate: 10, max_step: 0.01}\n"));
  Recorder recorder(simulation);
  run_to_the_end(simulation, recorder);
  const Vec3 start = vertex(recorder.positions.front(), 2);
  double time = 0;
  for (std::size_t step = 1; step < recorder.positions.size(); ++step) {
    time += recorder.records[step - 1].dt;
    const double moved = (vertex(recorder.positions[step], 2) - start).norm();
    if (time < 0.0501)
      EXPECT_EQ(moved, 0) << time;
    else
      EXPECT_GT(moved, 1e-4) << time;
  }
  EXPECT_EQ(simulation.pins().find_jump(simulation.cloth(), simulation.state()), std::nullopt)
      << "a run that goes on from here finds nothing off its pin";
}

TEST(RejectedSteps, AreCountedOneByOne) {
  Simulation simulation(world, case_of("cloth: {grid: {size: [1, 1], vertices: [15, 15]}}\n"
                                       "pins: [{vertices: [0]}, {vertices: [14], release: 0.1}]\n"
                                       "time: {end: 0.3, frame_rate: 10, max_step: 0.05}\n"
                                       "inextensibility: {max_iterations: 3}\n"));
  Recorder recorder(simulation);
  run_to_the_end(simulation, recorder);
  Global rejected = 0;
  for (const StepRecord& r : recorder.records) rejected += r.rejected;
  EXPECT_GT(rejected, 0);
  EXPECT_EQ(simulation.rejected_steps(), rejected);
}

// [BW98 section 6]: after a growth that failed, wait longer before the next.
TEST(StepSize, WaitsTwiceAsLongAfterAGrowthThatFailed) {
  StepSize size({.end = 10, .frame_rate = 0.1, .max_step = 0.16});
  size.rejected(0.16);
  for (const int patience : {2, 4, 8, 16, 32, 40, 40}) {
    EXPECT_EQ(size.memory().patience, patience);
    for (int k = 1; k < patience; ++k) {
      size.accepted();
      EXPECT_DOUBLE_EQ(size.memory().step, 0.16 / 1.25) << k << " of " << patience;
    }
    size.accepted();
    EXPECT_DOUBLE_EQ(size.memory().step, 0.16);
    size.rejected(0.16);
  }
  for (int k = 0; k < 41; ++k) size.accepted();
  size.rejected(0.16); // long after it grew: no failure of growth
  EXPECT_EQ(size.memory().patience, 40);
}

TEST(Thickness, IsATenthOfTheMeanEdgeByDefault) {
  const Case input = case_of("cloth: {grid: {size: [1, 2], vertices: [11, 11]}}\ncontact: {}\n");
  const Cloth cloth = load_cloth(world, input);
  EXPECT_NEAR(Thickness(cloth, input).largest(), 0.1 * (0.1 + 0.2) / 2, 1e-12);
}

TEST(ContactMemory, KeepsTheLesserOfTwoSteps) {
  const ContactImpulse weak{2, Vec3(0.5, 0, 0)}, strong{5, Vec3(3, 0, 0)};
  for (const auto& [before, now] : {std::pair{weak, strong}, {strong, weak}}) {
    const ContactImpulse both = lasting(before, now);
    EXPECT_EQ(both.normal, 2);
    EXPECT_NEAR(both.tangent.x(), 0.5, 1e-15);
  }
  EXPECT_EQ(lasting(weak, {1, Vec3(-3, 0, 0)}).tangent, Vec3(Vec3::Zero())) << "rubs the other way";
}

// With three digits both would be 0.01.
TEST(Acceptance, TellsStrainAndLimitApart) {
  const Case input = case_of("cloth: {grid: {size: [1, 1], vertices: [4, 4]}}\n");
  const Cloth cloth = load_cloth(world, input);
  const Acceptance acceptance(cloth, resolve(input, cloth), std::nullopt);
  const std::string fault = acceptance.fault_of({}, {}, {.max = 0.0100004});
  EXPECT_EQ(fault, "the measured strain is 0.0100004, over the limit 0.01");
  EXPECT_EQ(acceptance.fault_of({}, {}, {.max = 0.025}), "the measured strain is 0.025, over the limit 0.01");
}
