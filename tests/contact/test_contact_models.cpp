// Contact by impulses and by penalty springs, and what frames say of contact.
#include "io/whole_file.hpp"
#include "src/contact/gap_gauge.hpp"
#include "src/contact/penalty_springs.hpp"
#include "src/output/intersection_check.hpp"
#include "tests/folder.hpp"
#include "tests/simulate.hpp"

#include <fmt/format.h>

namespace taut::test {
namespace {

/// A patch of 81 vertices on the plane through the origin that is inclined by `angle` (rad).
Case patch_on_a_plane(const std::string& contact, double angle = 0, double friction = 0.3,
                      const char* cells = "quads") {
  const Vec3 normal(std::sin(angle), 0, std::cos(angle));
  Case input =
      case_of(fmt::format("cloth: {{grid: {{size: [0.1, 0.1], vertices: [9, 9], cells: {}}}}}\n"
                          "time: {{end: 0.2, frame_rate: 10, max_step: 0.005}}\n"
                          "obstacles:\n  - {{plane: {{normal: [{:.17g}, 0, {:.17g}]}}, friction: {}}}\n"
                          "contact: {{thickness: 0.001, check: step, {}}}\n",
                          cells, normal[0], normal[2], friction, contact));
  input.cloths[0].start.rotate = {Vec3::UnitY(), angle};
  input.cloths[0].start.translate = 1e-3 * normal;
  return input;
}

Vec3 sum_of(std::span<const Vec3> field) {
  std::array<double, 3> sum{};
  for (const Vec3& v : field)
    for (int k = 0; k < 3; ++k) sum[k] += v[k];
  sum_in_place(world, sum);
  return Vec3(sum[0], sum[1], sum[2]);
}

double mean_speed(const Simulation& simulation) {
  const auto owned = std::span(simulation.state().velocities).first(simulation.cloth().mesh.vertices.owned);
  return sum_of(owned).norm() / double(simulation.cloth().mesh.vertices.total);
}

/// After 0.2 s; nothing intersects at any step.
template<std::derived_from<Observer>... Observers>
void run(Simulation& simulation, const Case& input, Observers&... observers) {
  IntersectionCheck check(simulation.cloth(), simulation.obstacles(), input);
  run_to_the_end(simulation, check, observers...);
  EXPECT_EQ(check.count(), 0) << check.first();
}

/// What presses the cloth on the mean of all steps after 0.1 s. (Of one step, a program may leave a part.)
class MeanForce : public Observer {
public:
  void after_step(const State& state, const StepRecord& record) override {
    if (state.time < 0.1) return;
    impulse_ += record.dt * sum_of(state.reported.contact_force);
    time_ += record.dt;
  }
  Vec3 value() const { return impulse_ / time_; }

private:
  Vec3 impulse_ = Vec3::Zero();
  double time_ = 0;
};

TEST(ContactForce, CarriesTheWeight) {
  for (const auto& [model, cells] : {std::pair("model: constraint", "quads"),
                                     {"model: constraint", "triangles"},
                                     {"model: impulse", "quads"},
                                     {"model: penalty", "quads"}}) {
    const Case input = patch_on_a_plane(model, 0, 0.3, cells);
    Simulation simulation(world, input);
    MeanForce pressed;
    run(simulation, input, pressed);
    EXPECT_NEAR(pressed.value()[2], simulation.weight(), 0.02 * simulation.weight()) << model << cells;
    EXPECT_LT(pressed.value().head<2>().norm(), 0.02 * simulation.weight()) << model << cells;
  }
}

TEST(GapGauge, MeasuresTheDistanceToAPlane) {
  const Case input = patch_on_a_plane("model: constraint");
  Simulation simulation(world, input);
  const std::size_t owned = simulation.cloth().mesh.vertices.owned;
  std::vector<Vec3> bodies;
  simulation.obstacles().place(0, bodies);
  for (const double reach : {0.0005, 0.002}) {
    GapGauge gauge(simulation.cloth(), simulation.obstacles(), reach);
    const auto gaps = gauge.measure(simulation.state().positions, bodies);
    ASSERT_EQ(gaps.size(), owned);
    for (const double gap : gaps) EXPECT_NEAR(gap, std::min(reach, 0.001), 1e-12);
  }
}

/// A strip folded over itself: every vertex of one half lies `apart` over one of the other.
TEST(GapGauge, MeasuresTheDistanceOfALayerToAnother) {
  const double apart = 0.003;
  const Case input = case_of("cloth: {grid: {size: [0.2, 0.1], vertices: [21, 11]}}\n"
                             "contact: {thickness: 0.002}\n");
  Simulation simulation(world, input);
  std::vector<Vec3> folded = simulation.state().positions;
  for (Vec3& x : folded)
    if (x[0] > 0.105) x = Vec3(0.2 - x[0], x[1], apart);
  GapGauge gauge(simulation.cloth(), simulation.obstacles(), 0.005);
  const auto gaps = gauge.measure(folded, {});
  for (std::size_t i = 0; i < gaps.size(); ++i)
    if (folded[i][0] < 0.085) {
      EXPECT_NEAR(gaps[i], apart, 1e-12);
    }
}

/// A patch on another that is pinned: what it sinks in is less than its heaviest vertex would on one spring.
TEST(PenaltySprings, YieldToTheWeightOfACloth) {
  const double stiffness = 5;
  const Case input = case_of("cloths:\n"
                             "  - grid: {size: [0.1, 0.1], vertices: [9, 9]}\n"
                             "  - grid: {size: [0.08, 0.08], vertices: [9, 9]}\n"
                             "    start: {translate: [0.011, 0.012, 0.001]}\n"
                             "pins: [{range: [0, 80]}]\n"
                             "time: {end: 0.3, frame_rate: 10, max_step: 0.005}\n"
                             "contact: {model: penalty, thickness: 0.001, check: step, "
                             "penalty: {stiffness: 5, damping: 0.02}}\n");
  Simulation simulation(world, input);
  run(simulation, input);
  const Cloth& cloth = simulation.cloth();
  double deepest = 0, heaviest = 0;
  for (Local i = 0; i < cloth.mesh.vertices.owned; ++i) {
    if (cloth.mesh.vertices.original[i] < 81) continue;
    deepest = std::max(deepest, 0.001 - simulation.state().positions[i][2]);
    heaviest = std::max(heaviest, cloth.mass[i]);
  }
  const double most = max_over(world, heaviest) * 9.81 / stiffness;
  EXPECT_GT(max_over(world, deepest), 0.1 * most);
  EXPECT_LT(max_over(world, deepest), 1.05 * most);
}

double lowest_of(const Simulation& simulation) {
  return -lowest(simulation.cloth(), simulation.state().positions, -Vec3::UnitZ());
}

TEST(SolidConstraints, AlterPositionsWithoutVelocity) {
  Case input = patch_on_a_plane("model: penalty");
  input.cloths[0].start.translate = Vec3(0, 0, 4e-4); // 0.6 mm too near
  input.time.end = input.time.max_step = 0.005;
  input.time.frame_rate = 200;
  Simulation simulation(world, input);
  run(simulation, input);
  for (Local i = 0; i < simulation.cloth().mesh.vertices.owned; ++i) {
    EXPECT_NEAR(simulation.state().positions[i][2], 1e-3, 1e-9);
    EXPECT_LT(simulation.state().velocities[i].norm(), 1e-6);
  }
}

/// From a floor that falls away faster than the cloth, the cloth is let go: it falls freely.
TEST(SolidConstraints, LetGoWhatWouldPull) {
  Case input = patch_on_a_plane("model: penalty");
  input.time.max_step = 0.001;
  input.obstacles[0].motion = {{0.1, Vec3::Zero(), {}}, {0.2, -Vec3::UnitZ(), {}}};
  Simulation simulation(world, input);
  run(simulation, input);
  const double freely = 0.5 * 9.81 * 0.1 * 0.1;
  EXPECT_NEAR(lowest_of(simulation), 1e-3 - freely, 0.05 * freely);
}

TEST(SolidConstraints, HoldAPatchBelowCoulombsAngle) {
  const double friction = 0.4;
  for (const double off : {-0.02, 0.02}) { // rad
    const Case input = patch_on_a_plane("model: penalty", std::atan(friction) + off, friction);
    Simulation simulation(world, input);
    run(simulation, input);
    const double slides =
        0.2 * 9.81 * (std::sin(std::atan(friction) + off) - friction * std::cos(std::atan(friction) + off));
    if (off < 0) {
      EXPECT_LT(mean_speed(simulation), 2e-3);
    } else {
      EXPECT_GT(mean_speed(simulation), 0.5 * slides);
    }
  }
}

/// From 0.1 s to 0.2 s: at the start penalty springs have to be pressed before they rub.
TEST(Friction, SlidesAsCoulombSaysWithEveryModel) {
  const double angle = 0.6, friction = 0.4;
  const double expected = 0.1 * 9.81 * (std::sin(angle) - friction * std::cos(angle));
  for (const char* model : {"model: impulse", "model: penalty, penalty: {stiffness: 50, damping: 0.002}"}) {
    std::array<double, 2> speeds{};
    for (int k = 0; k < 2; ++k) {
      Case input = patch_on_a_plane(model, angle, friction);
      input.time.end = 0.1 * (k + 1);
      input.time.max_step = 0.002; // the speed that the springs' friction knows is one step late
      Simulation simulation(world, input);
      run(simulation, input);
      speeds[k] = mean_speed(simulation);
    }
    EXPECT_NEAR(speeds[1] - speeds[0], expected, 0.05 * expected) << model;
  }
}

TEST(Friction, HoldsASteepEnoughPlaneWithImpulses) {
  const double angle = 0.2, friction = 0.4;
  const Case input = patch_on_a_plane("model: impulse", angle, friction);
  Simulation simulation(world, input);
  run(simulation, input);
  EXPECT_LT(mean_speed(simulation), 1e-3);
}

/// The top of a ball of 100 m that turns is a moving belt: it drags the patch until both are as fast.
TEST(Friction, OfATurningBallDragsCloth) {
  for (const char* model : {"constraint", "impulse", "penalty"}) {
    const Case input = case_of(
        fmt::format("cloth: {{grid: {{size: [0.1, 0.1], vertices: [9, 9]}}, start: {{translate: [-0.05, "
                    "-0.05, 0.001]}}}}\n"
                    "time: {{end: 0.2, frame_rate: 10, max_step: 0.005}}\n"
                    "obstacles:\n  - sphere: {{centre: [0, 0, -100], radius: 100}}\n    friction: 0.3\n"
                    "    motion: [{{time: 0}}, {{time: 1, rotate: {{axis: [0, 1, 0], angle: 0.002, centre: "
                    "[0, 0, -100]}}}}]\n"
                    "contact: {{thickness: 0.001, model: {}}}\n",
                    model));
    Simulation simulation(world, input);
    run(simulation, input);
    const auto owned = std::span(simulation.state().velocities).first(simulation.cloth().mesh.vertices.owned);
    const Vec3 speed = sum_of(owned) / double(simulation.cloth().mesh.vertices.total);
    EXPECT_NEAR(speed[0], 0.2, 0.02) << model; // reached after 0.07 s
    EXPECT_NEAR(speed[1], 0.0, 0.01) << model;
  }
}

/// A strip lies across a ridge, which its edges alone meet; the ridge moves along itself, and takes it along.
TEST(PenaltySprings, RubAgainstAMovingEdge) {
  const Folder folder;
  write_text_whole(
      world, folder / "ridge.obj",
      "v -0.05 -0.3 -0.1\nv 0.05 -0.3 -0.1\nv 0 -0.3 0\nv -0.05 0.3 -0.1\nv 0.05 0.3 -0.1\nv 0 0.3 0\n"
      "f 1 2 3\nf 4 6 5\nf 1 4 5 2\nf 2 5 6 3\nf 3 6 4 1\n");
  const Case input = case_of(fmt::format(
      "cloth: {{grid: {{size: [0.1, 0.1], vertices: [8, 8]}}, start: {{translate: [-0.05, -0.05, "
      "0.001]}}}}\n"
      "time: {{end: 0.04, frame_rate: 25, max_step: 0.001}}\n"
      "obstacles: [{{mesh: {}, friction: 0.5, motion: [{{time: 0}}, {{time: 1, translate: [0, 0.05, "
      "0]}}]}}]\n"
      "contact: {{thickness: 0.001, model: penalty}}\n",
      (folder / "ridge.obj").string()));
  Simulation simulation(world, input);
  run(simulation, input);
  const auto owned = std::span(simulation.state().velocities).first(simulation.cloth().mesh.vertices.owned);
  const double speed = sum_of(owned)[1] / double(simulation.cloth().mesh.vertices.total);
  EXPECT_GT(speed, 0.025);
  EXPECT_LT(speed, 0.055);
}

/// Dropped on a ball, folding over itself.
constexpr const char* drop =
    "cloth:\n"
    "  grid: {size: [0.6, 0.6], vertices: [17, 17]}\n"
    "  start: {translate: [-0.3, -0.3, 0.21], rotate: {axis: [1, 2, 0], angle: 0.2}}\n"
    "obstacles:\n"
    "  - sphere: {centre: [0, 0, 0.08], radius: 0.08}\n"
    "  - plane: {}\n"
    "velocity: {tolerance: 1e-8}\n"
    "time: {end: 0.4, frame_rate: 10, max_step: 0.005}\n";

/// The largest strain of any step.
double drop_without_intersection(const std::string& contact) {
  const Case input = case_of(drop + contact);
  Simulation simulation(world, input);
  IntersectionCheck check(simulation.cloth(), simulation.obstacles(), input);
  Recorder record(simulation);
  Observer* const observers[] = {&check, &record};
  const Outcome outcome = simulation.run(observers);
  EXPECT_TRUE(outcome.completed()) << outcome.reason;
  EXPECT_EQ(check.count(), 0) << check.first();
  double strain = 0, lowest = HUGE_VAL;
  Global contacts = 0;
  for (const StepRecord& r : record.records) {
    strain = std::max(strain, r.strain.max);
    contacts = std::max(contacts, r.counts.contacts);
  }
  const Column& end = record.positions.back();
  for (Global i = 2; i < end.size(); i += 3) lowest = std::min(lowest, end[i]);
  EXPECT_GT(contacts, 50);
  EXPECT_GT(lowest, 0.0);
  EXPECT_LT(lowest, 0.03); // it has come down
  return strain;
}

TEST(ImpulseContact, NeverIntersectsWhenItHasTheLastWord) {
  EXPECT_GT(drop_without_intersection("contact: {model: impulse, thickness: 2.0e-3, check: step}\n"), 0.0);
}

TEST(ImpulseContact, LeavesTheStrainToTheProjectionWhenThatIsLast) {
  const Case input = case_of(std::string(drop) + "contact: {model: impulse, thickness: 2.0e-3, check: none, "
                                                 "impulse: {order: contact_first}}\n");
  Simulation simulation(world, input);
  EXPECT_EQ(simulation.strain_limit(), 0.01);
  Recorder record(simulation);
  run_to_the_end(simulation, record);
  for (const StepRecord& r : record.records) EXPECT_LE(r.strain.max, 0.01);
}

TEST(ImpulseContact, GoesWithEveryMethod) {
  for (const char* method : {"icd", "sap", "gauss_seidel", "springs", "none"}) {
    Case input = case_of(fmt::format("{}contact: {{model: impulse, thickness: 2.0e-3, check: step}}\n"
                                     "inextensibility: {{method: {}}}\n",
                                     drop, method));
    input.time.end = 0.1;
    Simulation simulation(world, input);
    run(simulation, input);
  }
}

/// The springs of a crumpled sheet as a linear system: whatever the partition, symmetric and not negative.
TEST(PenaltySprings, MakeASymmetricPositiveSystem) {
  const Case input = case_of("cloth: {grid: {size: [0.6, 0.6], vertices: [17, 17]}}\n"
                             "obstacles: [{sphere: {centre: [0.3, 0.3, -0.1], radius: 0.1}}]\n"
                             "contact: {model: penalty, thickness: 0.015}\n");
  const auto forms = [&](MPI_Comm comm) {
    Simulation simulation(comm, input);
    const Cloth& cloth = simulation.cloth();
    const Pattern pattern(cloth.mesh);
    PenaltySprings springs(cloth, simulation.obstacles(), input);
    State state = simulation.state();
    const auto noise = random_vectors(cloth.mesh.vertices.total, 0.03, 7),
               first = random_vectors(cloth.mesh.vertices.total, 1, 8),
               second = random_vectors(cloth.mesh.vertices.total, 1, 9);
    std::vector<Vec3> x, y, product(cloth.mesh.vertices.size());
    for (Local i = 0; i < cloth.mesh.vertices.size(); ++i) {
      const Global v = cloth.mesh.vertices.original[i];
      state.positions[i] += noise[v];
      x.push_back(first[v]);
      y.push_back(second[v]);
    }
    StepSystem system(pattern, cloth.mesh.vertices.size());
    system.start(0.01);
    springs.add_to(system, state);
    std::array<double, 4> sums{}; // x A x, y A x, x A y, x . b
    const auto add = [&](double& sum, const std::vector<Vec3>& left, std::span<const Vec3> right) {
      for (Local i = 0; i < cloth.mesh.vertices.owned; ++i) sum += left[i].dot(right[i]);
    };
    system.matrix().multiply(x, product);
    add(sums[0], x, product);
    add(sums[1], y, product);
    system.matrix().multiply(y, product);
    add(sums[2], x, product);
    add(sums[3], x, system.rhs());
    sum_in_place(comm, sums);
    return sums;
  };
  const auto mine = forms(world), alone = forms(self);
  EXPECT_GT(mine[0], 0);
  EXPECT_NEAR(mine[1], mine[2], 1e-9 * mine[0]);
  for (int k = 0; k < 4; ++k) EXPECT_NEAR(mine[k], alone[k], 1e-9 * alone[0]);
}

} // namespace
} // namespace taut::test
