#include "io/hdf5.hpp"
#include "src/output/step_log.hpp"
#include "src/output/summary.hpp"
#include "tests/folder.hpp"
#include "tests/petsc_options.hpp"
#include "tests/resume.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <fstream>
#include <sstream>

using namespace taut;
using namespace taut::test;
using testing::HasSubstr;

namespace {

namespace fs = std::filesystem;

/// Two corners held, one moving and the other let go; the longest step is too long for it, so that steps are
/// rejected.
std::string falling_cloth(const std::string& rest) {
  return "cloth:\n"
         "  grid: {size: [1, 1], vertices: [15, 15]}\n"
         "  material: {density: 0.2, bending: 1e-5, shear: 10, damping: {mass: 0.1, stiffness: 1e-3}}\n"
         "pins:\n"
         "  - vertices: [0]\n"
         "    motion: [{time: 0}, {time: 0.1, translate: [0.1, 0.05, 0]}, {time: 0.2}]\n"
         "  - vertices: [14]\n"
         "    release: 0.15\n"
         "air: {wind: [0, 1, 0.5]}\n"
         "time: {end: 0.3, frame_rate: 10, max_step: 0.05}\n" +
         rest;
}

const std::string direct = "velocity: {solver: mumps}\ninextensibility: {solver: mumps, max_iterations: 3}\n";
const std::string iterative = "inextensibility: {max_iterations: 3}\n";

/// Runs on `before` ranks until `steps` are done, leaves a checkpoint, and goes on from it on `after` ranks.
/// Compares with the run on `before` ranks that is not broken, on rank 0.
void expect_unbroken(const std::string& text, int before, int after, Global steps, double tolerance) {
  SCOPED_TRACE(fmt::format("{} ranks, after step {} on {}", before, steps, after));
  const Folder folder;
  const Result unbroken = run_whole(text, before);
  run_and_cut(text, before, steps, folder / "a.h5");
  const Result resumed = go_on(text, after, folder / "a.h5");
  if (rank_of(world) != 0) return;
  EXPECT_GT(unbroken.rejected, 0) << "the case is to try the memory of the step size";
  EXPECT_EQ(resumed.steps, unbroken.steps);
  EXPECT_EQ(resumed.rejected, unbroken.rejected);
  EXPECT_LE(distance(resumed, unbroken), tolerance);
  if (tolerance > 0) return;
  EXPECT_EQ(resumed.velocities, unbroken.velocities);
  EXPECT_EQ(resumed.force_densities, unbroken.force_densities);
}

int all() { return size_of(world); }

std::string contents(const fs::path& file) {
  MPI_Barrier(world);
  std::ifstream in(file);
  std::ostringstream text;
  text << in.rdbuf();
  MPI_Barrier(world); // nobody writes while another reads
  return text.str();
}

/// The message read_checkpoint gives.
std::string refusal(const fs::path& file, const DistributedMesh& mesh) {
  try {
    read_checkpoint(file, mesh);
  } catch (const InputError& e) {
    return e.what();
  }
  return "accepted";
}

void copy_first(const fs::path& from, const fs::path& to, double share) {
  MPI_Barrier(world);
  if (rank_of(world) == 0) {
    fs::copy_file(from, to);
    fs::resize_file(to, std::uintmax_t(share * double(fs::file_size(from))));
  }
  MPI_Barrier(world);
}

} // namespace

TEST(Resume, OnTheSameRanksIsEqualToTheBit) {
  for (const Global steps : {1, 7, 16, 25})
    expect_unbroken(falling_cloth(iterative), all(), all(), steps, 0.0);
}

TEST(Resume, WithNewtonIsEqualToTheBit) {
  for (const Global steps : {1, 7})
    expect_unbroken(falling_cloth("inextensibility: {method: newton, max_iterations: 2}\n"), all(), all(),
                    steps, 0.0);
}

TEST(Resume, WithDirectSolversIsEqualOnAnyRanks) {
  expect_unbroken(falling_cloth(direct), all(), 1, 7, 1e-9);
  expect_unbroken(falling_cloth(direct), 1, all(), 7, 1e-9);
  expect_unbroken(falling_cloth(direct), all(), (all() + 1) / 2, 16, 1e-9);
}

// Tolerances far below the default ones: with those, runs on different ranks differ by 1e-4 m.
TEST(Resume, WithConjugateGradientsIsEqualOnAnyRanks) {
  const OptionsInForce tight({{"-velocity_ksp_rtol", "1e-12"}, {"-projection_ksp_rtol", "1e-12"}});
  expect_unbroken(falling_cloth(iterative), all(), 1, 7, 1e-6);
  expect_unbroken(falling_cloth(iterative), (all() + 1) / 2, all(), 7, 1e-6);
}

TEST(Checkpoint, HoldsEverything) {
  const Folder folder;
  Simulation simulation(world, case_of(falling_cloth("")));
  EXPECT_EQ(simulation.run({}, [&] { return simulation.state().step == 3; }).ending, Ending::interrupted);
  Checkpoint written = checkpoint_of(simulation);
  written.case_text = std::string(300000, 'x') + "\nend: äöü\n"; // pins may name a great many vertices
  written.step_size = {.step = 0.1 / 3, .successes = 2, .patience = 16, .grew = true};
  written.rejected_steps = 17;
  Totals& t = written.totals;
  t.steps = Global(1) << 40;
  t.counts = {.velocity_iterations = 7,
              .iterations = 5,
              .linear_iterations = 6,
              .contacts = 11,
              .contacts_if_even = 12,
              .contacts_across = 3,
              .smallest_gap = 1e-3,
              .velocity_seconds = 0.1,
              .projection_seconds = 0.2,
              .contact_seconds = 0.6,
              .cpu_seconds = 0.25};
  t.iterations_max = 8, t.contacts_max = 9, t.intersections = 10;
  t.strain_max = 1.0 / 3, t.strain_squares = 1e-300, t.strain_limit = 0.01;
  t.histogram = {double(rank_of(world)), 1.0};
  t.seconds = 0.3, t.setup_seconds = 0.4, t.output_seconds = 0.5;
  written.balance = {.steps = 13, .waste = 0.7, .least = 1.0 / 3};
  write_checkpoint(folder / "a.h5", simulation.cloth().mesh, written);
  const Checkpoint read = read_checkpoint(folder / "a.h5", simulation.cloth().mesh);

  EXPECT_EQ(read.case_text, written.case_text);
  EXPECT_EQ(read.state.time, written.state.time);
  EXPECT_EQ(read.state.step, 3);
  EXPECT_EQ(read.state.positions, written.state.positions) << "ghosts too";
  EXPECT_EQ(read.state.velocities, written.state.velocities);
  EXPECT_EQ(read.state.multipliers.force_density, written.state.multipliers.force_density);
  EXPECT_EQ(read.state.multipliers.projection_tension, written.state.multipliers.projection_tension);
  EXPECT_EQ(read.state.multipliers.carried_contact_force, written.state.multipliers.carried_contact_force);
  EXPECT_EQ(read.step_size.step, 0.1 / 3);
  EXPECT_EQ(read.step_size.successes, 2);
  EXPECT_EQ(read.step_size.patience, 16);
  EXPECT_TRUE(read.step_size.grew);
  EXPECT_EQ(read.rejected_steps, 17);
  EXPECT_EQ(read.balance, written.balance);
  EXPECT_EQ(read.state.start_depth, written.state.start_depth);
  const Totals& r = read.totals;
  EXPECT_EQ(r.steps, t.steps);
  EXPECT_EQ(r.counts, t.counts);
  EXPECT_EQ(std::tie(r.iterations_max, r.contacts_max, r.intersections),
            std::tie(t.iterations_max, t.contacts_max, t.intersections));
  EXPECT_EQ(std::tie(r.strain_max, r.strain_squares, r.strain_limit),
            std::tie(t.strain_max, t.strain_squares, t.strain_limit));
  EXPECT_EQ(std::tie(r.seconds, r.setup_seconds, r.output_seconds),
            std::tie(t.seconds, t.setup_seconds, t.output_seconds));
  std::vector<double> histogram = r.histogram;
  sum_in_place(world, histogram);
  EXPECT_EQ(histogram, (std::vector<double>{all() * (all() - 1) / 2.0, double(all())}));
}

TEST(Checkpoint, RefusesWhatIsNoneOfTheRun) {
  const Folder folder;
  Simulation simulation(world, case_of(falling_cloth("")));
  const DistributedMesh& mesh = simulation.cloth().mesh;
  write_checkpoint(folder / "whole.h5", mesh, checkpoint_of(simulation));
  EXPECT_EQ(refusal(folder / "whole.h5", mesh), "accepted");
  for (const double share : {0.0, 0.1, 0.9, 0.999}) {
    const std::string name = fmt::format("{}.h5", share);
    copy_first(folder / "whole.h5", folder / name, share);
    EXPECT_THAT(refusal(folder / name, mesh), HasSubstr(name + ": it does not end with its checksum"));
  }
  EXPECT_THAT(refusal(folder / "none.h5", mesh), HasSubstr("no such file"));

  write_whole(world, folder / "foreign.h5", [&](H5Writer& file) { file.attribute("time", 1.0); });
  EXPECT_THAT(refusal(folder / "foreign.h5", mesh), HasSubstr("taut_checkpoint cannot be read"));
  write_whole(world, folder / "later.h5",
              [&](H5Writer& file) { file.attribute("taut_checkpoint", Global(99)); });
  EXPECT_THAT(refusal(folder / "later.h5", mesh), HasSubstr("a checkpoint of format 99"));

  Simulation other(world,
                   case_of("cloth: {grid: {size: [1, 1], vertices: [15, 14]}}\npins: [{vertices: [0]}]\n"));
  EXPECT_THAT(refusal(folder / "whole.h5", other.cloth().mesh), HasSubstr("has 225 rows instead of 210"));

  Checkpoint broken = checkpoint_of(simulation);
  if (rank_of(world) == all() - 1) broken.state.velocities[0].y() = NAN;
  write_checkpoint(folder / "broken.h5", mesh, broken);
  EXPECT_THAT(refusal(folder / "broken.h5", mesh),
              HasSubstr("velocities: it holds a number that is not finite"));
}

TEST(Checkpoint, RefusesValuesThatNoRunLeaves) {
  const Folder folder;
  Simulation simulation(world, case_of(falling_cloth("")));
  const Checkpoint sound = checkpoint_of(simulation);
  const auto refused = [&](const std::string& words, const std::function<void(Checkpoint&)>& spoil) {
    Checkpoint spoilt = sound;
    spoil(spoilt);
    write_checkpoint(folder / "a.h5", simulation.cloth().mesh, spoilt);
    EXPECT_THAT(refusal(folder / "a.h5", simulation.cloth().mesh), HasSubstr(words + " cannot be its value"));
  };
  refused("time: -1", [](Checkpoint& c) { c.state.time = -1; });
  refused("time: inf", [](Checkpoint& c) { c.state.time = HUGE_VAL; });
  refused("step: -1", [](Checkpoint& c) { c.state.step = -1; });
  refused("longest_step: 0", [](Checkpoint& c) { c.step_size.step = 0; });
  refused("longest_step: nan", [](Checkpoint& c) { c.step_size.step = NAN; });
  refused("patience: 0", [](Checkpoint& c) { c.step_size.patience = 0; });
  refused("rejected_steps: -1", [](Checkpoint& c) { c.rejected_steps = -1; });
}

TEST(Checkpoint, FilesAreFoundByTheirNames) {
  const Folder folder;
  EXPECT_TRUE(checkpoints_in(folder / "run").empty());
  MPI_Barrier(world);
  EXPECT_EQ(step_of_checkpoint(checkpoint_file("run", 12)), 12);
  EXPECT_EQ(step_of_checkpoint(checkpoint_file("run", 12345678901)), 12345678901);
  for (const char* name : {"step_.h5", "step_1x.h5", "step_000000012.h5.part", "frame_000001.h5", "step_12"})
    EXPECT_EQ(step_of_checkpoint(name), -1) << name;
  if (rank_of(world) == 0) {
    fs::create_directories(folder / "run/checkpoint");
    for (const Global step : {9, 100, 20}) std::ofstream(checkpoint_file(folder / "run", step));
    std::ofstream(folder / "run/checkpoint/notes.txt");
  }
  MPI_Barrier(world);
  const fs::path run = folder / "run";
  EXPECT_EQ(checkpoints_in(run), (std::vector<fs::path>{checkpoint_file(run, 100), checkpoint_file(run, 20),
                                                        checkpoint_file(run, 9)}));
}

TEST(StepSize, KnowsTheFrameAfterATime) {
  for (const double rate : {1.0, 3.0, 29.97, 100.0}) {
    const StepSize steps({.end = 2.05, .frame_rate = rate});
    EXPECT_EQ(steps.frame_after(0.0), 1);
    for (Global frame = 1; frame <= steps.frames(); ++frame) {
      EXPECT_EQ(steps.frame_after(steps.frame_time(frame)), frame + 1) << rate;
      EXPECT_EQ(steps.frame_after(steps.frame_time(frame) - 1e-3), frame) << rate;
    }
  }
}

TEST(StepSize, ShortensWhatLaboursButNotWithoutEnd) {
  config::Time time;
  time.end = 1;
  time.frame_rate = 1;
  time.max_step = 0.01;
  StepSize size(time);
  for (int i = 0; i < 20; ++i) {
    const double dt = size.choose(0, 1).dt;
    size.accepted();
    size.too_costly(dt);
  }
  EXPECT_LT(size.choose(0, 1).dt, 0.0013);
  EXPECT_GT(size.choose(0, 1).dt, 0.0006);
  for (int i = 0; i < 200; ++i) size.accepted();
  EXPECT_DOUBLE_EQ(size.choose(0, 1).dt, 0.01);
}

TEST(StepSize, ShrinksFasterWhereStepsKeepFailing) {
  config::Time time;
  time.end = 1;
  time.frame_rate = 1;
  time.max_step = 0.01;
  StepSize size(time);
  const auto reject = [&] {
    const double dt = size.choose(0, 1).dt;
    size.rejected(dt);
    return dt / size.choose(0, 1).dt;
  };
  EXPECT_NEAR(reject(), 1.25, 0.02); // steps are equal within a frame
  EXPECT_NEAR(reject(), 1.5625, 0.02);
  for (int i = 0; i < 3; ++i) reject();
  EXPECT_NEAR(reject(), 2, 0.02);
  size.accepted();
  EXPECT_NEAR(reject(), 1.25, 0.02);
}

TEST(StepSize, TakesNoTinyLastStep) {
  for (const double end : {0.5, 0.5 + 1e-6, 0.5 + 4e-4}) {
    const StepSize steps({.end = end, .frame_rate = 30, .max_step = 5e-3});
    EXPECT_EQ(steps.frames(), 15);
    EXPECT_EQ(steps.frame_time(14), 14.0 / 30);
    EXPECT_EQ(steps.frame_time(15), end);
  }
  const StepSize steps({.end = 0.502, .frame_rate = 30, .max_step = 5e-3});
  EXPECT_EQ(steps.frames(), 16);
  EXPECT_EQ(steps.frame_time(15), 0.5);
}

TEST(StepLog, GoesOnWithTheRowsOfAnEarlierRun) {
  const Folder folder;
  State state;
  const auto write = [&](const std::vector<std::string>& energies, Global last, Global first, Global end) {
    StepLog log(world, folder / "steps.csv", energies, 0, last);
    for (state.step = first; state.step < end; ++state.step) {
      StepRecord record;
      record.depth = double(state.step) / 4;
      record.energies.potential.assign(energies.size(), double(state.step));
      log.after_step(state, record);
    }
  };
  write({"gravity"}, 0, 1, 7);
  const std::string whole = contents(folder / "steps.csv");
  write({"gravity"}, 4, 5, 7);
  EXPECT_EQ(contents(folder / "steps.csv"), whole) << "rows after the checkpoint come once";

  if (rank_of(world) == 0) std::ofstream(folder / "steps.csv", std::ios::app) << "7,0.1,0."; // cut off here
  write({"gravity"}, 6, 7, 7);
  EXPECT_EQ(contents(folder / "steps.csv"), whole) << "half a row is dropped";

  write({"air", "gravity"}, 2, 3, 4);
  EXPECT_THAT(contents(folder / "steps.csv"), HasSubstr("kinetic_J,air_J,gravity_J,velocity_s"));
  EXPECT_THAT(contents(folder / "steps.csv"),
              HasSubstr("\n2,0,0,0,0,0,0.5,0,0,0,0,0,0,,2,0,0,0\n3,0,0,0,0,0,0.75,"));
  write({"gravity"}, 0, 1, 7);
  EXPECT_EQ(contents(folder / "steps.csv"), whole) << "begun anew";
}

// The figures of a run do not depend on where it was cut.
TEST(Summary, CountsTheStepsBeforeARunWasResumed) {
  const Case input = case_of(falling_cloth(iterative));
  Simulation whole(world, input), cut(world, input);
  const IntersectionCheck none(whole.cloth(), whole.obstacles(), input);
  Summary all_of_it(whole, input, none, {}, MPI_Wtime()), first(cut, input, none, {}, MPI_Wtime());
  run_to_the_end(whole, all_of_it);
  Observer* const observers[] = {&first};
  cut.run(observers, [&] { return cut.state().step == 16; });
  Summary second(cut, input, none, first.totals(0.0), MPI_Wtime());
  run_to_the_end(cut, second);
  const Totals a = all_of_it.totals(0), b = second.totals(0);
  EXPECT_EQ(std::tie(a.steps, a.counts.iterations, a.iterations_max, a.strain_max, a.histogram),
            std::tie(b.steps, b.counts.iterations, b.iterations_max, b.strain_max, b.histogram));
  EXPECT_EQ(a.strain_squares, b.strain_squares);

  Case stricter = input;
  stricter.inextensibility.strain /= 2;
  const Totals rescaled = Summary(whole, stricter, none, a, MPI_Wtime()).totals(0);
  EXPECT_EQ(rescaled.strain_limit, 0.005);
  for (const std::size_t bin : {1u, 100u, 400u}) {
    double old = 0;
    for (std::size_t k = 0; k <= bin; ++k) old += a.histogram[k];
    double present = 0;
    for (std::size_t k = 0; k <= 2 * bin; ++k) present += rescaled.histogram[k];
    EXPECT_EQ(present, old) << "as many edges below the same strain";
  }
}
