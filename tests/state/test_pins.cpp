// Pins that let vertices slide, and the forces with which pins hold.
#include "tests/simulate.hpp"

#include <fmt/format.h>

using namespace taut;
using namespace taut::test;

namespace {

constexpr double g = 9.81, h = 0.01;
const std::string exact = "velocity: {solver: mumps}\n", stretchy = "inextensibility: {method: none}\n",
                  tight = "inextensibility: {strain: 1e-6, solver: mumps, max_iterations: 50}\n";
const std::string sheet = "cloth: {grid: {size: [0.5, 0.4], vertices: [6, 5]}, material: {stretch: 300}}\n";

std::string limited_by(const std::string& method) {
  return "inextensibility: {strain: 1e-3, method: " + method + "}\n";
}

/// Velocities after each step, three rows a vertex.
Dense velocities_of(const Recorder& r) {
  Dense v(r.positions[0].size(), Global(r.records.size()));
  for (std::size_t n = 0; n < r.records.size(); ++n)
    v.col(Global(n)) = (r.positions[n + 1] - r.positions[n]) / r.records[n].dt;
  return v;
}

Vec3 momentum(const Simulation& simulation, const Column& velocity) {
  const Cloth& cloth = simulation.cloth();
  std::vector<double> sum(3, 0.0);
  for (Local i = 0; i < cloth.mesh.vertices.owned; ++i)
    for (int k = 0; k < 3; ++k) sum[k] += cloth.mass[i] * velocity[3 * cloth.mesh.vertices.original[i] + k];
  sum_in_place(cloth.mesh.comm, sum);
  return {sum[0], sum[1], sum[2]};
}

double mass_of(const Simulation& simulation) {
  double mass = 0;
  for (Local i = 0; i < simulation.cloth().mesh.vertices.owned; ++i) mass += simulation.cloth().mass[i];
  return sum_over(world, mass);
}

Vec3 sum_of(const std::vector<Vec3>& forces) {
  Vec3 sum = Vec3::Zero();
  for (const Vec3& f : forces) sum += f;
  return sum;
}

} // namespace

TEST(Pins, OfARangeAreThoseOfTheList) {
  const auto drop = [](const std::string& pin) {
    Simulation simulation(world,
                          case_of(sheet + "pins: [{" + pin + "}]\ntime: {end: 0.05, frame_rate: 20}\n"));
    Recorder record(simulation);
    run_to_the_end(simulation, record);
    return record.positions.back();
  };
  EXPECT_EQ(drop("range: [3, 6]"), drop("vertices: [3, 4, 5, 6]"));
  EXPECT_THROW(drop("range: [3, 30]"), InputError);
  EXPECT_THROW(drop("range: [6, 3]"), InputError);
}

// The change of momentum in a step is h times weight and pin forces, whatever else goes on inside the cloth.
TEST(PinForces, AndTheWeightChangeTheMomentum) {
  for (const std::string& solver :
       {exact, std::string("velocity: {tolerance: 1e-13, constraints: modified_cg}\n")}) {
    Simulation simulation(
        world, case_of(sheet + solver + stretchy +
                       "pins:\n"
                       "  - {vertices: [0], motion: [{time: 0}, {time: 0.1, translate: [0.05, 0, 0.02]}]}\n"
                       "  - {vertices: [5, 29], along: [1, 1, 0]}\n"
                       "  - {vertices: [24], plane: [0, 0.6, 0.8]}\n"
                       "time: {end: 0.2, frame_rate: 5, max_step: 0.01}\n"));
    Recorder r(simulation);
    run_to_the_end(simulation, r);
    const Dense v = velocities_of(r);
    const Vec3 weight(0, 0, -g * mass_of(simulation));
    for (Global n = 1; n < v.cols(); ++n) {
      const Vec3 change = momentum(simulation, v.col(n)) - momentum(simulation, v.col(n - 1));
      ASSERT_EQ(r.records[n].pin_forces.size(), 3u);
      EXPECT_LT((change / h - weight - sum_of(r.records[n].pin_forces)).norm(), 1e-8 * weight.norm());
      // A pin does not push where it lets slide.
      EXPECT_NEAR(r.records[n].pin_forces[1].dot(Vec3(1, 1, 0)), 0, 1e-10);
      EXPECT_NEAR(r.records[n].pin_forces[2].cross(Vec3(0, 0.6, 0.8)).norm(), 0, 1e-10);
    }
  }
}

// With a projection after the prediction, the pins hold against its tension too; at rest all is in balance.
TEST(PinForces, OfAClothAtRestBearItsWeight) {
  Simulation simulation(world,
                        case_of("cloth:\n"
                                "  line: {length: 0.5, vertices: 11}\n"
                                "  material: {density: 0.1, bending: 0, damping: {mass: 20}}\n"
                                "pins: [{vertices: [0]}, {vertices: [10], motion: [{time: 0}, {time: 0.2, "
                                "translate: [-0.1, 0, 0]}]}]\n"
                                "time: {end: 4, frame_rate: 1, max_step: 0.01}\n" +
                                tight + exact));
  Recorder r(simulation);
  run_to_the_end(simulation, r);
  const auto& forces = r.records.back().pin_forces;
  const double weight = g * mass_of(simulation);
  EXPECT_NEAR(sum_of(forces)[2], weight, 1e-4 * weight);
  EXPECT_NEAR(forces[0][2], forces[1][2], 1e-4 * weight); // by symmetry
  EXPECT_NEAR(forces[0][0], -forces[1][0], 1e-4 * weight);
  EXPECT_LT(forces[0][0], -0.1 * weight); // it pulls away from the other
}

TEST(PinForces, AreToldByEveryMethodAndIntegrator) {
  struct Choice {
    std::string method;
    double tolerance; ///< sweeps to a limit end before tensions are in balance
    std::string integrator = "implicit_euler";
  };
  const std::vector<Choice> choices{{"fast_projection", 1e-4},
                                    {"fast_projection", 1e-4, "bdf2"},
                                    {"fast_projection", 1e-4, "imex"},
                                    {"icd", 1e-4},
                                    {"sap", 1e-4},
                                    {"shake", 1e-4},
                                    {"rattle", 1e-4},
                                    {"jacobi", 0.06},
                                    {"gauss_seidel", 0.06},
                                    {"xpbd", 1e-4},
                                    {"springs, springs: {stiffness: 500}", 1e-4}};
  for (const auto& [method, tolerance, integrator] : choices) {
    SCOPED_TRACE(method + ", " + integrator);
    Simulation simulation(world, case_of("cloth:\n"
                                         "  line: {length: 0.5, vertices: 6}\n"
                                         "  material: {density: 0.1, bending: 0, damping: {mass: 10}}\n"
                                         "pins: [{vertices: [0]}]\n"
                                         "time: {end: 2.5, frame_rate: 2, max_step: 0.02, integrator: " +
                                         integrator + "}\n" + limited_by(method) + exact));
    Recorder r(simulation);
    run_to_the_end(simulation, r);
    const double weight = g * mass_of(simulation);
    EXPECT_LT((r.records.back().pin_forces[0] - Vec3(0, 0, weight)).norm(), tolerance * weight);
  }
}

TEST(SlidingPins, StayOnTheirLineAndFeelNothingAlongIt) {
  constexpr double solved = 1e-6; // as exactly as linear systems are solved
  const std::vector<std::pair<std::string, double>> methods{
      {stretchy, 1e-12},
      {tight, 1e-12},
      {limited_by("icd"), solved},
      {limited_by("sap"), solved},
      {limited_by("shake"), 1e-12},
      {limited_by("rattle"), 1e-12},
      {limited_by("jacobi"), 1e-12},
      {limited_by("gauss_seidel"), 1e-12},
      {limited_by("xpbd"), 1e-12},
      {limited_by("springs, springs: {stiffness: 300}"), 1e-12}};
  for (const auto& [method, tolerance] : methods) {
    SCOPED_TRACE(method);
    Simulation simulation(world,
                          case_of("cloth: {line: {length: 0.5, vertices: 6}, material: {stretch: 300}}\n"
                                  "pins: [{vertices: [0], along: [2, 0, 0]}]\n"
                                  "time: {end: 0.3, frame_rate: 5, max_step: 0.01}\n" +
                                  method + exact));
    Recorder r(simulation);
    run_to_the_end(simulation, r);
    const Dense v = velocities_of(r);
    double travelled = 0;
    for (std::size_t n = 0; n < r.positions.size(); ++n) {
      EXPECT_NEAR(r.positions[n][1], r.positions[0][1], 1e-14);
      EXPECT_NEAR(r.positions[n][2], r.positions[0][2], 1e-14);
      travelled = std::max(travelled, std::abs(r.positions[n][0] - r.positions[0][0]));
    }
    EXPECT_GT(travelled, 0.01); // the falling line draws it along
    for (const StepRecord& record : r.records) EXPECT_EQ(record.pin_forces[0][0], 0);
    for (Global n = 0; n < v.cols(); ++n) EXPECT_NEAR(momentum(simulation, v.col(n))[0], 0, tolerance);
  }
}

// A plane through the pin that turns about the y axis carries the vertex only across itself.
TEST(SlidingPins, PlanesMoveAndTurnWithTheirKeyframes) {
  Simulation simulation(
      world, case_of(sheet + exact + stretchy +
                     "pins:\n"
                     "  - vertices: [0, 5]\n"
                     "    plane: [0, 0, 1]\n"
                     "    motion: [{time: 0}, {time: 0.3, translate: [0, 0, 0.1], rotate: {axis: [0, "
                     "1, 0], angle: 0.5}}]\n"
                     "time: {end: 0.3, frame_rate: 5, max_step: 0.01}\n"));
  Recorder r(simulation);
  run_to_the_end(simulation, r);
  const Vec3 normal(std::sin(0.5), 0, std::cos(0.5)), point(0, 0, 0.1);
  for (const Global v : {0, 5}) {
    const Vec3 end = r.positions.back().segment<3>(3 * v);
    EXPECT_NEAR((end - point).dot(normal), 0, 1e-12);
  }
}
