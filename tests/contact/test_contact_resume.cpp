// What is remembered of contacts from step to step, in checkpoints too.
#include "io/hdf5.hpp"
#include "tests/folder.hpp"
#include "tests/resume.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

namespace taut::test {
namespace {

using testing::HasSubstr;

/// A square that comes down on a sphere, off its middle, and slides off it against friction.
std::string draped(double end, std::string_view solver) {
  return fmt::format("cloth:\n"
                     "  grid: {{size: [0.4, 0.4], vertices: [15, 15]}}\n"
                     "  start: {{translate: [-0.19, -0.18, 0.2025]}}\n"
                     "  material: {{density: 0.2, bending: 1e-4, shear: 10, damping: {{mass: 1}}}}\n"
                     "obstacles: [{{sphere: {{centre: [0, 0, 0.1], radius: 0.1}}}}]\n"
                     "contact: {{thickness: 2.0e-3, friction: 0.4}}\n"
                     "velocity: {{solver: {1}}}\n"
                     "inextensibility: {{solver: {1}}}\n"
                     "time: {{end: {0}, frame_rate: 10, max_step: 0.005}}\n",
                     end, solver);
}

/// An upright square that folds onto itself and the floor.
constexpr const char* folding =
    "cloth:\n"
    "  grid: {size: [0.2, 0.2], vertices: [13, 13]}\n"
    "  start: {translate: [0, 0, 0.205], rotate: {axis: [0, 1, 0.1], angle: 80 deg}}\n"
    "obstacles: [{plane: {}}]\n"
    "contact: {thickness: 3.0e-3}\n"
    "time: {end: 0.2, frame_rate: 10, max_step: 0.005}\n";

/// A held square that a small box hits from below at 4 m/s: pairs stop steps, and are forgotten by the next.
constexpr const char* hit = "cloth:\n"
                            "  grid: {size: [0.3, 0.3], vertices: [13, 13]}\n"
                            "pins: [{vertices: [0, 12, 156, 168]}]\n"
                            "obstacles:\n"
                            "  - box: {min: [0.13, 0.12, -0.08], max: [0.18, 0.17, -0.03]}\n"
                            "    motion: [{time: 0}, {time: 0.02, translate: [0, 0, 0.08]}, {time: 0.1}]\n"
                            "contact: {thickness: 1.0e-3}\n"
                            "time: {end: 0.1, frame_rate: 10, max_step: 0.005}\n";

/// What a program may leave of a gap in a step of the draped square: 0.1 g dt^2, m.
constexpr double left_in_a_step = 0.1 * 9.81 * 0.005 * 0.005;

int all() { return size_of(world); }

Global contacts_in(const std::filesystem::path& checkpoint) {
  return H5Reader(world, checkpoint).rows("contacts/keys");
}

void forget(State& state) {
  state.multipliers.contacts.clear();
  std::fill(state.multipliers.projection_tension.begin(), state.multipliers.projection_tension.end(), 0.0);
}

/// Returns how many contacts the checkpoint holds.
Global expect_equal_to_the_bit(const std::string& text, Global steps) {
  SCOPED_TRACE(fmt::format("after step {}", steps));
  const Folder folder;
  const Result unbroken = run_whole(text, all());
  run_and_cut(text, all(), steps, folder / "a.h5");
  const Result resumed = go_on(text, all(), folder / "a.h5");
  EXPECT_EQ(resumed.steps, unbroken.steps);
  EXPECT_EQ(resumed.positions, unbroken.positions);
  EXPECT_EQ(resumed.velocities, unbroken.velocities);
  EXPECT_EQ(resumed.force_densities, unbroken.force_densities);
  return contacts_in(folder / "a.h5");
}

TEST(ContactResume, OnTheSameRanksIsEqualToTheBit) {
  EXPECT_EQ(expect_equal_to_the_bit(draped(0.1, "cg"), 1), 0) << "still in the air";
  EXPECT_GT(expect_equal_to_the_bit(draped(0.1, "cg"), 12), 5);
  EXPECT_GT(expect_equal_to_the_bit(folding, 35), 10);
  for (const Global steps : {3, 5, 8}) expect_equal_to_the_bit(hit, steps);
}

// Two steps on, unbroken runs on different ranks differ by what their programs leave, and so do resumed ones;
// without the memory of contacts it is far more.
TEST(ContactResume, OnOtherRanksDiffersAsUnbrokenRunsDo) {
  const Folder folder;
  const std::string text = draped(0.06, "mumps");
  const Result unbroken = run_whole(text, all()), on_one = run_whole(text, 1);
  run_and_cut(text, all(), 10, folder / "all.h5");
  run_and_cut(text, 1, 10, folder / "one.h5");
  const auto expect_near = [&](const Result& resumed, const Result& forgetful) {
    if (rank_of(world) != 0) return;
    EXPECT_EQ(resumed.steps, unbroken.steps);
    EXPECT_LE(distance(resumed, unbroken), 3 * left_in_a_step);
    EXPECT_GT(distance(forgetful, unbroken), 8 * left_in_a_step);
  };
  expect_near(go_on(text, 1, folder / "all.h5"), go_on(text, 1, folder / "all.h5", forget));
  expect_near(go_on(text, all(), folder / "one.h5"), go_on(text, all(), folder / "one.h5", forget));
  const int half = (all() + 1) / 2;
  expect_near(go_on(text, half, folder / "all.h5"), go_on(text, half, folder / "all.h5", forget));
  if (rank_of(world) == 0) {
    EXPECT_LE(distance(on_one, unbroken), 3 * left_in_a_step);
  }
}

// What a checkpoint holds of contacts is that of the step before it, once.
TEST(ContactResume, ForgetsWhatTheLastStepDidNotPress) {
  const Folder folder;
  const std::string text = draped(0.2, "cg");
  run_and_cut(text, all(), 12, folder / "a.h5");
  Simulation simulation(world, case_of(text));
  Checkpoint c = read_checkpoint(folder / "a.h5", simulation.cloth().mesh);
  const ContactKey foreign{0, 14, 210, 224};
  if (rank_of(world) == 0) c.state.multipliers.contacts[foreign].pressed.normal = 1;
  simulation.restore(std::move(c.state), c.step_size, c.rejected_steps);
  EXPECT_EQ(simulation.run({}, [&] { return simulation.state().step == 13; }).ending, Ending::interrupted);
  EXPECT_FALSE(any_of(world, simulation.state().multipliers.contacts.contains(foreign)));
  write_checkpoint(folder / "b.h5", simulation.cloth().mesh, checkpoint_of(simulation));
  run_and_cut(text, all(), 13, folder / "unbroken.h5");
  EXPECT_EQ(contacts_in(folder / "b.h5"), contacts_in(folder / "unbroken.h5"));
}

const Vec3 drift(1e-5, 2e-5, 0);

ContactEntry entry(double x) { return {{x, Vec3(2 * x, 0, 0)}, {3 * x, Vec3(0, 0, 4 * x)}, drift}; }

/// Normal and tangent of both parts, and the drift, as one.
Column column(const ContactEntry& e) {
  Column all(11);
  all << e.pressed.normal, e.pressed.tangent, e.carried.normal, e.carried.tangent, e.drift;
  return all;
}

/// A small mesh, and contacts that all ranks found, those of `key(k)` with k + 1 on each.
class Contacts : public testing::Test {
protected:
  static ContactKey key(Global k) {
    return k % 2 ? ContactKey{-2 - (7 * k + 3), 7 * k, 225 + k, -1} : ContactKey{225 + k, 7 * k, -1, -1};
  }
  Contacts() {
    ContactMemory found;
    for (Global k = 0; k < 30; ++k) found[key(k)] = entry(double(k + 1));
    at_home = bring_home(mesh, found);
  }
  double found_in_all(Global k) const { return double((k + 1) * all()); }

  Simulation simulation{world, case_of(draped(0.1, "cg"))};
  const DistributedMesh& mesh = simulation.cloth().mesh;
  ContactMemory at_home;
};

TEST_F(Contacts, LiveOnceWithTheSumOfWhatWasFound) {
  EXPECT_EQ(sum_over(world, Global(at_home.size())), 30);
  for (Global k = 0; k < 30; ++k) {
    const auto found = at_home.find(key(k));
    EXPECT_EQ(sum_over(world, Global(found != at_home.end())), 1);
    if (found != at_home.end()) {
      EXPECT_EQ(column(found->second), column(entry(found_in_all(k))));
    }
  }
}

TEST_F(Contacts, AreHandedOutOnceAndShared) {
  const bool asks_for_both = rank_of(world) % 2 == 0;
  std::vector<ContactKey> wanted{key(4), {5, 6, 8, -1}};
  if (asks_for_both) wanted.push_back(key(9));
  const ContactMemory mine = hand_out(mesh, at_home, wanted);
  EXPECT_EQ(mine.size(), asks_for_both ? 2u : 1u);
  EXPECT_LT((column(mine.at(key(4))) - column(entry(5.0))).norm(), 1e-12) << "a part for each rank";
  const double shared = found_in_all(9) / ((all() + 1) / 2);
  if (asks_for_both) {
    EXPECT_LT((column(mine.at(key(9))) - column(entry(shared))).norm(), 1e-12);
  }
  EXPECT_EQ(sum_over(world, Global(at_home.size())), 28);
  EXPECT_TRUE(hand_out(mesh, at_home, wanted).empty());
}

TEST(ContactEntry, DriftIsTheMeanByWhatPressed) {
  ContactEntry sum;
  sum += {{1, Vec3::Zero()}, {}, Vec3(0.1, 0, 0)};
  EXPECT_EQ(sum.drift, Vec3(0.1, 0, 0)) << "to the bit";
  sum += {{3, Vec3::Zero()}, {}, Vec3(0.5, 0, 0)};
  EXPECT_NEAR(sum.drift.x(), 0.4, 1e-15);
  EXPECT_EQ(sum.scaled(0.5).drift, sum.drift);
}

TEST_F(Contacts, ComeBackFromACheckpoint) {
  const Folder folder;
  Checkpoint written = checkpoint_of(simulation);
  written.state.multipliers.contacts = at_home;
  write_checkpoint(folder / "a.h5", mesh, written);
  EXPECT_EQ(contacts_in(folder / "a.h5"), 30);
  const ContactMemory read = read_checkpoint(folder / "a.h5", mesh).state.multipliers.contacts;
  ASSERT_EQ(read.size(), at_home.size());
  for (const auto& [k, e] : at_home) EXPECT_EQ(column(read.at(k)), column(e));
}

TEST_F(Contacts, WithoutTheClothAreRefused) {
  const Folder folder;
  Checkpoint broken = checkpoint_of(simulation);
  if (rank_of(world) == 0) broken.state.multipliers.contacts[{225, 226, -1, -1}] = entry(1);
  write_checkpoint(folder / "a.h5", mesh, broken);
  try {
    read_checkpoint(folder / "a.h5", mesh);
    FAIL() << "accepted";
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("contacts/keys: it names a contact without the cloth"));
  }
}

/// Two squares, the second one comes down on the first, which lies on the floor.
constexpr const char* comes_down = "cloths:\n"
                                   "  - {name: low, grid: {size: [0.4, 0.4], vertices: [17, 17]},\n"
                                   "     start: {translate: [0, 0, 0.005]}}\n"
                                   "  - {name: high, grid: {size: [0.4, 0.4], vertices: [17, 17]},\n"
                                   "     start: {translate: [0, 0, 0.05]}}\n"
                                   "obstacles: [{plane: {}}]\n"
                                   "contact: {thickness: 4.0e-3}\n"
                                   "time: {end: 0.2, frame_rate: 10, max_step: 0.005}\n";

/// Counts the contacts of all steps and those across ranks.
struct Across : Observer {
  Global contacts = 0, across = 0;
  void after_step(const State&, const StepRecord& record) override {
    contacts += record.counts.contacts;
    across += record.counts.contacts_across;
  }
};

/// The part of contacts that is across ranks from a checkpoint to the end.
double across_after(const std::filesystem::path& file, const Cut& cut) {
  Simulation simulation(world, case_of(comes_down), cut);
  Checkpoint c = read_checkpoint(file, simulation.cloth().mesh);
  simulation.restore(std::move(c.state), c.step_size, c.rejected_steps);
  Across seen;
  Observer* const observers[] = {&seen};
  EXPECT_TRUE(simulation.run(observers).completed());
  EXPECT_GT(seen.contacts, 289);
  return double(seen.across) / double(seen.contacts);
}

TEST(ContactResume, CutAnewKeepsLayersTogether) {
  const Folder folder;
  run_and_cut(comes_down, all(), 36, folder / "a.h5"); // some steps before the end they lie on each other
  const double as_before = across_after(folder / "a.h5", cut_of_checkpoint(folder / "a.h5"));
  const double anew = across_after(folder / "a.h5", cut_by_checkpoint(folder / "a.h5"));
  EXPECT_LE(anew, as_before);
  if (all() == 1) {
    EXPECT_EQ(as_before, 0);
  }
  if (all() == 2) {
    EXPECT_GT(as_before, 0.2) << "one square a rank";
    EXPECT_LT(anew, 0.5 * as_before);
  }
}

StepRecord record_of(Global contacts, Global if_even, Global across) {
  StepRecord record;
  record.counts.contacts = contacts;
  record.counts.contacts_if_even = if_even;
  record.counts.contacts_across = across;
  return record;
}

TEST(ContactBalance, WantsAnotherCutWhereMoreIsWasted) {
  ContactBalance balance(1000, {});
  const State state;
  const auto see = [&](int steps, const StepRecord& record) {
    for (int k = 0; k < steps; ++k) balance.after_step(state, record);
    return balance.wants_another_cut();
  };
  EXPECT_FALSE(see(50, record_of(1000, 1000, 0))) << "nothing is wasted";
  EXPECT_FALSE(see(50, record_of(1000, 1100, 20)));
  EXPECT_TRUE(see(50, record_of(1000, 1900, 0))) << "uneven";
  EXPECT_FALSE(see(50, record_of(1000, 1000, 0)));
  EXPECT_TRUE(see(50, record_of(1000, 1000, 200))) << "across";
}

TEST(ContactBalance, IsContentWithWhatACutCannotHelp) {
  const State state;
  ContactBalance balance(1000, {});
  for (int k = 0; k < 100; ++k) {
    balance.after_step(state, record_of(1000, 1500, 300));
    EXPECT_FALSE(balance.wants_another_cut());
  }
  ContactBalance few(100000, {});
  for (int k = 0; k < 100; ++k) {
    few.after_step(state, k < 50 ? record_of(0, 0, 0) : record_of(100, 400, 100));
    EXPECT_FALSE(few.wants_another_cut()) << "contact is hardly any of the work";
  }
}

TEST(ContactBalance, GoesOnFromItsMemory) {
  const State state;
  ContactBalance whole(1000, {}), first(1000, {});
  for (int k = 0; k < 7; ++k)
    for (ContactBalance* b : {&whole, &first}) b->after_step(state, record_of(500 + k, 600, 10 * k));
  ContactBalance second(1000, first.memory());
  for (int k = 0; k < 7; ++k)
    for (ContactBalance* b : {&whole, &second}) b->after_step(state, record_of(700, 900 + k, 0));
  EXPECT_EQ(whole.memory(), second.memory());
}

} // namespace
} // namespace taut::test
