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
