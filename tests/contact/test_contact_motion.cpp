// Contact in the time step: the quadratic program, friction, and what a run with contact promises.
#include "src/contact/gap_gauge.hpp"
#include "src/linear/bounded_qp.hpp"
#include "src/output/intersection_check.hpp"
#include "tests/folder.hpp"
#include "tests/simulate.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <fstream>
#include <sstream>

namespace taut::test {
namespace {

using testing::HasSubstr;

/// Every rank holds one part of a dense problem of which it knows everything.
TEST(BoundedQp, SatisfiesItsOptimalityConditions) {
  const int ranks = size_of(world), me = rank_of(world), part = 6, n = part * ranks;
  for (unsigned seed = 0; seed < 20; ++seed) {
    const std::size_t unbounded = seed % 3;
    const auto numbers = random_numbers(Global(n) * n + n, 1.0, seed);
    const Dense b = Eigen::Map<const Dense>(numbers.data(), n, n);
    const Dense a = b * b.transpose() + 0.1 * Dense::Identity(n, n);
    const Column rhs = Eigen::Map<const Column>(numbers.data() + n * n, n);
    const auto everywhere = [&](std::span<const double> mine) {
      Column all = Column::Zero(n);
      for (int i = 0; i < part; ++i) all[part * me + i] = mine[i];
      sum_in_place(world, {all.data(), std::size_t(n)});
      return all;
    };
    std::vector<double> my_rhs, lower, upper, tolerance(part, 1e-10), z(part, 0.0);
    for (int i = 0; i < part; ++i) my_rhs.push_back(rhs[part * me + i]);
    for (int i = int(unbounded); i < part; ++i) {
      lower.push_back(i % 3 == 0 ? -HUGE_VAL : i % 3 == 1 ? 0.0 : -0.1);
      upper.push_back(i % 3 == 2 ? 0.1 : HUGE_VAL);
    }
    const BoundedQp qp{[&](std::span<const double> x, std::span<double> y) {
                         const Column product = a * everywhere(x);
                         for (int i = 0; i < part; ++i) y[i] = product[part * me + i];
                       },
                       [&](std::span<const double> x, std::span<double> y) {
                         for (int i = 0; i < part; ++i) y[i] = x[i] / a(part * me + i, part * me + i);
                       },
                       my_rhs,
                       unbounded,
                       lower,
                       upper,
                       tolerance};
    const QpReport report = solve(world, qp, {20000}, z);
    EXPECT_TRUE(report.solved);
    const Column gradient = a * everywhere(z) - rhs;
    for (int i = 0; i < part; ++i) {
      const double g = gradient[part * me + i];
      const double low = i < int(unbounded) ? -HUGE_VAL : lower[i - unbounded];
      const double high = i < int(unbounded) ? HUGE_VAL : upper[i - unbounded];
      EXPECT_GE(z[i], low);
      EXPECT_LE(z[i], high);
      if (z[i] > low) {
        EXPECT_LE(g, 1e-8);
      }
      if (z[i] < high) {
        EXPECT_GE(g, -1e-8);
      }
    }
  }
}

TEST(BoundedQp, WithoutBoundsEndsAsConjugateGradientsDo) {
  const int n = 40;
  std::vector<double> diagonal(n), rhs(n, 1.0), tolerance(n, 1e-9), z(n, 0.0);
  for (int i = 0; i < n; ++i) diagonal[i] = 1 + i % 5; // five eigenvalues: five iterations
  const BoundedQp qp{
      [&](std::span<const double> x, std::span<double> y) {
        for (int i = 0; i < n; ++i) y[i] = diagonal[i] * x[i];
      },
      [&](std::span<const double> x, std::span<double> y) { std::copy(x.begin(), x.end(), y.begin()); },
      rhs,
      std::size_t(n),
      {},
      {},
      tolerance};
  const QpReport report = solve(world, qp, {100}, z);
  EXPECT_TRUE(report.solved);
  EXPECT_LE(report.products, 7);
}

/// Entries are gone through in runs of some hundreds, those with bounds and those without.
TEST(BoundedQp, KeepsEachEntryWithItsOwnBounds) {
  const std::size_t n = 3000, unbounded = 1300;
  std::vector<double> rhs(n), lower, upper, tolerance(n, 1e-9), z(n, 0.0);
  for (std::size_t i = 0; i < n; ++i) {
    rhs[i] = double(i % 7) - 3;
    if (i < unbounded) continue;
    lower.push_back(-1e-4 * double(i));
    upper.push_back(2e-4 * double(i));
  }
  const auto copy = [](std::span<const double> x, std::span<double> y) {
    std::copy(x.begin(), x.end(), y.begin());
  };
  EXPECT_TRUE(solve(world, {copy, copy, rhs, unbounded, lower, upper, tolerance}, {100}, z).solved);
  for (std::size_t i = 0; i < n; ++i) {
    const bool is_bounded = i >= unbounded;
    const double expected =
        is_bounded ? std::clamp(rhs[i], lower[i - unbounded], upper[i - unbounded]) : rhs[i];
    ASSERT_NEAR(z[i], expected, 1e-8) << i;
  }
}

/// Quads, and triangles, which resist stretching.
constexpr const char* all_cells[] = {"quads", "triangles"};

constexpr const char* patch = "cloth: {{grid: {{size: [0.1, 0.1], vertices: [9, 9], cells: {}}}}}\n"
                              "velocity: {{tolerance: 1e-8}}\n"
                              "time: {{end: 0.2, frame_rate: 10, max_step: 0.005}}\n";

/// A patch on a plane through the origin that is inclined by `angle` (rad); its motion after `end` seconds.
struct Slid {
  Vec3 moved = Vec3::Zero();
  double speed = 0;
};
Slid slide(const char* cells, double angle, double friction, double end = 0.2) {
  const Vec3 normal(std::sin(angle), 0, std::cos(angle));
  const Vec3 start = 1e-3 * normal;
  const Case input = case_of(fmt::format("{}obstacles:\n  - {{plane: {{normal: [{:.17g}, 0, {:.17g}]}}, "
                                         "friction: {}}}\ncontact: {{thickness: 0.001, check: step}}\n",
                                         fmt::format(patch, cells), normal[0], normal[2], friction));
  Case turned = input;
  turned.cloths[0].start.rotate = {Vec3::UnitY(), angle};
  turned.cloths[0].start.translate = start;
  turned.time.end = end;
  Simulation simulation(world, turned);
  IntersectionCheck check(simulation.cloth(), simulation.obstacles(), turned);
  const auto centre = [&] {
    std::array<double, 3> sum{};
    for (Local i = 0; i < simulation.cloth().mesh.vertices.owned; ++i)
      for (int k = 0; k < 3; ++k) sum[k] += simulation.state().positions[i][k] / 81;
    sum_in_place(world, sum);
    return Vec3(sum[0], sum[1], sum[2]);
  };
  const Vec3 before = centre();
  run_to_the_end(simulation, check);
  EXPECT_EQ(check.count(), 0);
  double speed = 0;
  for (Local i = 0; i < simulation.cloth().mesh.vertices.owned; ++i)
    speed += simulation.state().velocities[i].norm() / 81;
  return {centre() - before, sum_over(world, speed)};
}

TEST(Friction, SticksBelowCoulombsAngle) {
  const double limit = std::atan(0.5), degree = std::acos(-1.0) / 180;
  for (const char* cells : all_cells)
    EXPECT_LT(slide(cells, limit - degree, 0.5).moved.norm(), 2e-4) << cells;
}

// What programs leave of slip does not add up from step to step: to 1.5 mm here, if it did.
TEST(Friction, DoesNotCreepWhereItSticks) {
  const double angle = std::atan(0.5) - 0.25 * std::acos(-1.0) / 180;
  for (const char* cells : all_cells) EXPECT_LT(slide(cells, angle, 0.5, 4).moved.norm(), 3e-5) << cells;
}

TEST(Friction, SlidesAboveItAsCoulombSays) {
  const double limit = std::atan(0.5), degree = std::acos(-1.0) / 180;
  for (const char* cells : all_cells) {
    SCOPED_TRACE(cells);
    for (const double angle : {limit + degree, limit + 5 * degree}) {
      const double acceleration = 9.81 * (std::sin(angle) - 0.5 * std::cos(angle));
      EXPECT_NEAR(slide(cells, angle, 0.5).speed, 0.2 * acceleration, 1e-3 + 0.01 * 0.2 * acceleration);
    }
    EXPECT_NEAR(slide(cells, limit, 0.0).speed, 0.2 * 9.81 * std::sin(limit), 1e-3);
  }
}

TEST(ContactProjection, WithoutContactIsFastProjectionToTheLastDigit) {
  // Pulled taut between its pins, which Fast Projection has a metric for; the floor is out of reach.
  const std::string scene =
      "cloth: {grid: {size: [1, 1], vertices: [9, 9]}, start: {translate: [0, 0, 5]}}\n"
      "pins: [{vertices: [0]}, {vertices: [8], motion: [{time: 0}, {time: 0.1, translate: [0.005, 0, 0]}]}]\n"
      "inextensibility: {method: fast_projection}\n"
      "time: {end: 0.2, frame_rate: 10, max_step: 0.01}\n";
  Simulation plain(world, case_of(scene));
  Recorder expected(plain);
  run_to_the_end(plain, expected);
  Simulation with_contact(world, case_of(scene + "contact: {thickness: 0.001}\nobstacles: [{plane: {}}]\n"));
  Recorder found(with_contact);
  run_to_the_end(with_contact, found);
  ASSERT_EQ(found.positions.size(), expected.positions.size());
  for (std::size_t k = 0; k < found.positions.size(); ++k)
    EXPECT_EQ(found.positions[k], expected.positions[k]) << k;
}

/// Dropped on every kind of obstacle, folding over itself.
constexpr const char* heap =
    "cloth:\n"
    "  grid: {size: [0.6, 0.6], vertices: [17, 17]}\n"
    "  start: {translate: [-0.3, -0.3, 0.31], rotate: {axis: [1, 2, 0], angle: 0.2}}\n"
    "obstacles:\n"
    "  - sphere: {centre: [0, 0, 0.15], radius: 0.08}\n"
    "  - capsule: {from: [0.2, -0.2, 0.1], to: [0.2, 0.2, 0.1], radius: 0.03}\n"
    "  - box: {min: [-0.3, -0.1, 0.0], max: [-0.2, 0.1, 0.12]}\n"
    "  - plane: {}\n"
    "contact: {thickness: 2.0e-3, check: step}\n"
    "time: {end: 0.5, frame_rate: 10, max_step: 0.005}\n";

TEST(ContactProjection, HoldsStrainAndNeverIntersects) {
  const Case input = case_of(heap);
  Simulation simulation(world, input);
  IntersectionCheck check(simulation.cloth(), simulation.obstacles(), input);
  Recorder record(simulation);
  Observer* const observers[] = {&check, &record};
  const Outcome outcome = simulation.run(observers);
  EXPECT_TRUE(outcome.completed()) << outcome.reason;
  EXPECT_EQ(check.count(), 0) << check.first();
  Global contacts = 0;
  for (const StepRecord& r : record.records) {
    EXPECT_LE(r.strain.max, 0.01);
    contacts = std::max(contacts, r.counts.contacts);
  }
  EXPECT_GT(contacts, 70);
  std::vector<Vec3> bodies;
  simulation.obstacles().place(simulation.state().time, bodies);
  double gap = HUGE_VAL;
  for (const double g : GapGauge(simulation.cloth(), simulation.obstacles(), 4e-3)
                            .measure(simulation.state().positions, bodies))
    gap = std::min(gap, g);
  EXPECT_NEAR(record.records.back().counts.smallest_gap, -max_over(world, -gap), 1e-9);
  EXPECT_GT(gap, 0.0);
  // it has come down on the obstacles and not through them
  const Column& end = record.positions.back();
  double low = HUGE_VAL, high = -HUGE_VAL;
  for (Global i = 2; i < end.size(); i += 3) low = std::min(low, end[i]), high = std::max(high, end[i]);
  EXPECT_GT(low, 0.0);
  EXPECT_LT(low, 0.02);
  EXPECT_GT(high, 0.22);
}

// What lies on pinned cloth, its pins bear.
TEST(ContactProjection, TellsPinsWhatPressesOnThem) {
  for (const auto& [cells, velocity, model, tolerance] :
       {std::tuple("quads", "solver: mumps", "constraint", 0.02),
        {"triangles", "tolerance: 1e-8", "constraint", 0.02},
        {"triangles", "solver: mumps", "constraint", 0.02},
        {"quads", "solver: mumps", "impulse", 0.06}}) {
    SCOPED_TRACE(fmt::format("{} {} {}", cells, velocity, model));
    Simulation simulation(
        world, case_of(fmt::format(
                   "cloths:\n"
                   "  - {{name: lower, grid: {{size: [0.1, 0.1], vertices: [5, 5], cells: {0}}}}}\n"
                   "  - {{name: upper, grid: {{size: [0.1, 0.1], vertices: [5, 5], cells: {0}}},\n"
                   "     start: {{translate: [0.013, 0.007, 0.002]}}, material: {{damping: {{mass: 20}}}}}}\n"
                   "pins: [{{cloth: lower, range: [0, 24]}}]\n"
                   "velocity: {{{2}}}\n"
                   "contact: {{thickness: 0.002, model: {1}}}\n"
                   "time: {{end: 0.7, frame_rate: 10, max_step: 0.005}}\n",
                   cells, model, velocity)));
    Recorder r(simulation);
    run_to_the_end(simulation, r);
    EXPECT_NEAR(r.records.back().pin_forces[0][2], simulation.weight(), tolerance * simulation.weight());
  }
}

TEST(ContactProjection, FallsAlikeAtAnyNumberOfRanksUntilItTouches) {
  const auto run = [](MPI_Comm comm) {
    Case input = case_of(heap);
    input.time.end = 0.1;
    input.cloths[0].start.translate[2] += 0.05;
    input.inextensibility.solver = input.velocity.solver = config::LinearSolver::mumps;
    Simulation simulation(comm, input);
    Recorder record(simulation);
    run_to_the_end(simulation, record);
    return record.positions.back();
  };
  EXPECT_LT((run(world) - run(self)).cwiseAbs().maxCoeff(), 1e-6);
}

// What the last step left of strain and overlap is corrected over some time, not at once.
TEST(ContactProjection, IsNotShakenByStepsThatAreSuddenlyShort) {
  Case input = case_of(heap);
  input.time.end = 0.3;
  Simulation simulation(world, input);
  Recorder before(simulation);
  run_to_the_end(simulation, before);
  input.time.end = 0.30002;
  Simulation shorter(world, input);
  shorter.restore(simulation.state(), {.step = 1e-5}, 0);
  Recorder after(shorter);
  run_to_the_end(shorter, after);
  ASSERT_EQ(after.records.size(), 2u);
  EXPECT_GT(after.records.back().counts.contacts, 60);
  EXPECT_NEAR(after.records.back().energies.kinetic / before.records.back().energies.kinetic, 1.0, 0.07);
}

TEST(ContactProjection, NamesAPinThatDragsClothThroughAnObstacle) {
  const Case input = case_of(
      "cloth: {grid: {size: [0.1, 0.1], vertices: [5, 5]}, start: {translate: [0, 0, 0.05]}}\n"
      "pins: [{vertices: [0, 4, 20, 24], motion: [{time: 0}, {time: 0.1, translate: [0, 0, -0.2]}]}]\n"
      "obstacles: [{name: table, plane: {}}]\n"
      "contact: {thickness: 0.001}\n"
      "time: {end: 0.1, max_step: 0.01, min_step: 0.001}\n");
  Simulation simulation(world, input);
  Recorder record(simulation);
  Observer* const observers[] = {&record};
  const Outcome outcome = simulation.run(observers);
  EXPECT_FALSE(outcome.completed());
  EXPECT_THAT(outcome.reason, HasSubstr("table"));
}

TEST(ContactProjection, RefusesPredictionsThatTearTheMesh) {
  Case input = case_of(fmt::format(patch, "quads") +
                       "pins: [{vertices: [0], motion: [{time: 0}, {time: 0.01, translate: [0, 0, 1000]}]}]\n"
                       "contact: {thickness: 0.001}\n");
  input.time.min_step = 4e-3; // shorter ones only fail to project
  Simulation simulation(world, input);
  Recorder record(simulation);
  Observer* const observers[] = {&record};
  const Outcome outcome = simulation.run(observers);
  EXPECT_FALSE(outcome.completed());
  EXPECT_THAT(outcome.reason, HasSubstr("without projection edges would strain by"));
}

TEST(ContactProjection, RefusesThicknessBeyondTheMesh) {
  const Case input = case_of(fmt::format(patch, "quads") + "contact: {thickness: 0.02}\n");
  EXPECT_THROW(Simulation(world, input), InputError);
}

TEST(IntersectionCheck, RefusesACrossedStart) {
  const Case input = case_of(fmt::format(patch, "quads") +
                             "obstacles: [{sphere: {centre: [0.05, 0.05, 0], radius: 0.02}}]\n");
  Simulation simulation(world, input);
  IntersectionCheck check(simulation.cloth(), simulation.obstacles(), input);
  const Folder folder;
  EXPECT_THROW(check.refuse(simulation.state(), folder / "some/findings.vtp"), InputError);
  EXPECT_GT(check.count(), 0);
  std::ostringstream read;
  read << std::ifstream(folder / "some/findings.vtp").rdbuf();
  const std::string text = read.str();
  EXPECT_THAT(text, HasSubstr(fmt::format("NumberOfPoints=\"{}\"", check.count())));
  EXPECT_THAT(text, HasSubstr("Name=\"obstacle\""));
}

} // namespace
} // namespace taut::test
