#include "tests/simulate.hpp"

#include <fmt/format.h>

using namespace taut;
using namespace taut::test;

namespace {

/// Two corners held, one of them moving; falls, swings and folds.
std::string drape(const std::string& rest) {
  return "cloth:\n"
         "  grid: {size: [1, 1], vertices: [21, 21]}\n"
         "  material: {density: 0.2, bending: 1e-5, shear: 10, damping: {mass: 0.1, stiffness: 1e-3}}\n"
         "pins:\n"
         "  - vertices: [0]\n"
         "    motion: [{time: 0}, {time: 0.3, translate: [0.1, 0.05, 0]}]\n"
         "  - vertices: [20]\n"
         "air: {wind: [0, 1, 0.5]}\n"
         "time: {end: 0.3, frame_rate: 10, max_step: 0.01}\n" +
         rest;
}

const std::string direct = "velocity: {solver: mumps}\ninextensibility: {solver: mumps}\n";

struct Run {
  Column positions; ///< at the end
  Global steps;
};

Run run(MPI_Comm comm, const std::string& text) {
  Simulation simulation(comm, case_of(text));
  const Outcome outcome = simulation.run({});
  EXPECT_TRUE(outcome.completed()) << outcome.reason;
  return {gather<Vec3>(comm, simulation.cloth().mesh.vertices, simulation.state().positions),
          simulation.state().step};
}

/// The run on one rank alone, told to all.
Run serial_run(const std::string& text) {
  Run alone{Column::Zero(3 * 21 * 21), 0};
  if (rank_of(world) == 0) alone = run(self, text);
  sum_in_place(world, {alone.positions.data(), std::size_t(alone.positions.size())});
  alone.steps = sum_over(world, alone.steps);
  return alone;
}

void expect_the_same_run(const std::string& settings, double tolerance) {
  const Run alone = serial_run(drape(settings));
  for (const std::string method : {"metis", "stripes"}) {
    const Run found = run(world, drape(settings + fmt::format("partition: {{method: {}}}\n", method)));
    EXPECT_EQ(found.steps, alone.steps);
    const Column difference = found.positions - alone.positions;
    EXPECT_LT(difference.reshaped(3, 21 * 21).colwise().norm().maxCoeff(), tolerance);
  }
}

} // namespace

// Only the order of sums differs, inside the factorisations: some 1e-14 m a step. The cloth is slack and
// folds, which makes differences grow.
TEST(Trajectory, IsTheSameAtAnyRankCountWithDirectSolvers) { expect_the_same_run(direct, 1e-9); }

// Conjugate gradients stop at a relative residual, each rank count in another place: 1e-3 of the change of
// velocity.
TEST(Trajectory, IsNearlyTheSameAtAnyRankCountWithConjugateGradients) { expect_the_same_run("", 1e-3); }

// Newton's method stops where what is left moves the cloth by a part of what gravity does.
TEST(Trajectory, IsNearlyTheSameAtAnyRankCountWithNewton) {
  expect_the_same_run("inextensibility: {method: newton, residual: 1e-3}\n", 1e-3);
}

namespace {

/// Falls on a ball and hangs down around it.
const std::string on_a_ball =
    "cloth:\n"
    "  grid: {size: [0.6, 0.6], vertices: [21, 21]}\n"
    "  start: {translate: [-0.3, -0.3, 0.22]}\n"
    "  material: {density: 0.2, bending: 1e-4, shear: 10, damping: {mass: 2, stiffness: 1e-3}}\n"
    "obstacles: [{sphere: {centre: [0, 0, 0], radius: 0.2}}]\n"
    "contact: {thickness: 2 mm, friction: 0.5}\n"
    "velocity: {tolerance: 1e-10}\n"
    "time: {end: 0.4, frame_rate: 100, max_step: 0.005}\n";

/// The positions at every frame.
class Frames : public Observer {
public:
  explicit Frames(const Simulation& simulation) : mesh_(simulation.cloth().mesh) {}

  void after_step(const State&, const StepRecord& record) override {
    touched_ = touched_ || record.counts.contacts > 0;
  }
  void after_frame(const State& state, Global) override {
    positions.push_back(gather<Vec3>(mesh_.comm, mesh_.vertices, state.positions));
    if (!touched_) before_contact = positions.size();
  }

  std::vector<Column> positions;
  std::size_t before_contact = 0; ///< frames without any

private:
  const DistributedMesh& mesh_;
  bool touched_ = false;
};

Frames frames_of(MPI_Comm comm) {
  Simulation simulation(comm, case_of(on_a_ball));
  Frames frames(simulation);
  run_to_the_end(simulation, frames);
  return frames;
}

double farthest(const Column& difference) {
  return difference.reshaped(3, difference.size() / 3).colwise().norm().maxCoeff();
}

/// Mean height, lowest point, and how far the cloth reaches from the ball's axis on average; m.
Vec3 statistics(const Column& positions) {
  const auto x = positions.reshaped(3, positions.size() / 3);
  return {x.row(2).mean(), x.row(2).minCoeff(), x.topRows(2).colwise().norm().mean()};
}

} // namespace

// Where contact begins, its program stops at a tolerance that is a part of what a vertex falls in a step,
// each rank count in another place; from then on differences grow as fast as in any scene with friction. What
// the cloth comes to is the same.
TEST(Trajectory, WithContactIsTheSameUntilItTouchesAndEndsAlike) {
  const Frames found = frames_of(world);
  if (rank_of(world) != 0) return;
  const Frames expected = frames_of(self);
  EXPECT_GE(expected.before_contact, 5u);
  EXPECT_EQ(found.before_contact, expected.before_contact);
  ASSERT_EQ(found.positions.size(), expected.positions.size());
  for (std::size_t k = 0; k < found.positions.size(); ++k) {
    const double apart = farthest(found.positions[k] - expected.positions[k]);
    EXPECT_LT(apart, k < found.before_contact ? 1e-9 : k < found.before_contact + 3 ? 2e-3 : 0.1) << k;
  }
  const Vec3 a = statistics(expected.positions.back()), b = statistics(found.positions.back());
  EXPECT_LT((a - b).cwiseAbs().maxCoeff(), 4e-3) << a.transpose() << "; " << b.transpose();
}
