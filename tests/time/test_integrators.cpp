#include "src/time/integrator.hpp"
#include "tests/simulate.hpp"

#include <fmt/format.h>

#include <cmath>
#include <complex>
#include <numbers>

using namespace taut;
using namespace taut::test;

namespace {

constexpr double g = 9.81; // m/s^2

/// A pendulum of 1 m, let go at `angle` from the vertical.
std::string pendulum(double angle, double end, double step, const std::string& integrator) {
  return fmt::format("cloth:\n"
                     "  line: {{length: 1, vertices: 2}}\n"
                     "  start: {{rotate: {{axis: [0, 1, 0], angle: {:.17g}}}}}\n"
                     "pins: [{{vertices: [0]}}]\n"
                     "time: {{end: {}, frame_rate: {}, max_step: {}, integrator: {}}}\n"
                     "inextensibility: {{strain: 1e-12, compliance: 0, solver: mumps}}\n"
                     "velocity: {{solver: mumps}}\n",
                     std::numbers::pi / 2 - angle, end, 1 / end, step, integrator);
}

Recorder swing(const std::string& text) {
  Simulation simulation(world, case_of(text));
  Recorder recorder(simulation);
  run_to_the_end(simulation, recorder);
  return recorder;
}

/// The amplitude of a small swing after each step: with w^2 = g/l, A^2 = x^2 + (v/w)^2.
class Amplitude : public Observer {
public:
  explicit Amplitude(const Cloth& cloth) : cloth_(cloth) {}
  void after_step(const State& state, const StepRecord&) override {
    const auto x_of = [&](const std::vector<Vec3>& field) {
      return gather<Vec3>(world, cloth_.mesh.vertices, field)[3];
    };
    values.push_back(std::hypot(x_of(state.positions), x_of(state.velocities) / std::sqrt(g)));
  }
  std::vector<double> values;

private:
  const Cloth& cloth_;
};

/// The part of the amplitude that 10 s leave, after the first second.
double amplitude_kept(const std::string& integrator, double h) {
  Simulation simulation(world, case_of(pendulum(1e-3, 11, h, integrator)));
  Amplitude amplitude(simulation.cloth());
  run_to_the_end(simulation, amplitude);
  const std::size_t second = std::size_t(std::lround(1 / h)) - 1;
  return amplitude.values.back() / amplitude.values[second];
}

/// What BDF2 leaves of x' = i w x in a step: (3/2 - i w h) z^2 - 2 z + 1/2 = 0.
double bdf2_factor(double wh) {
  const std::complex<double> a(1.5, -wh);
  return std::abs((2.0 + std::sqrt(4.0 - 2.0 * a)) / (2.0 * a));
}

/// Angle from the vertical after a swing from 1 rad at rest: theta'' = -g sin theta, by Runge and Kutta's
/// method.
double exact_angle(double time) {
  constexpr int steps = 20000;
  const double h = time / steps;
  double angle = 1, rate = 0;
  const auto f = [](double a) { return -g * std::sin(a); };
  for (int n = 0; n < steps; ++n) {
    const double k1 = rate, m1 = f(angle), k2 = rate + h / 2 * m1, m2 = f(angle + h / 2 * k1),
                 k3 = rate + h / 2 * m2, m3 = f(angle + h / 2 * k2), k4 = rate + h * m3,
                 m4 = f(angle + h * k3);
    angle += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
    rate += h / 6 * (m1 + 2 * m2 + 2 * m3 + m4);
  }
  return angle;
}

double angle_error(const std::string& integrator, double h) {
  constexpr double end = 0.4;
  const Column x = swing(pendulum(1, end, h, integrator)).positions.back();
  return std::abs(std::atan2(x[3], -x[5]) - exact_angle(end));
}

} // namespace

// Backward Euler leaves (1 + w^2 h^2)^(-1/2) of the amplitude in a step, w^2 = g/l.
TEST(Pendulum, KeepsItsAmplitudeWithBdf2AndNotWithEuler) {
  for (const auto& [h, euler, bdf2] :
       {std::tuple{0.02, 0.376, 0.998}, {0.01, 0.613, 0.9998}, {0.005, 0.783, 1.0}}) {
    const double kept_by_euler = amplitude_kept("implicit_euler", h),
                 kept_by_bdf2 = amplitude_kept("bdf2", h);
    EXPECT_NEAR(kept_by_euler, std::pow(1 + g * h * h, -5 / h), 1e-4);
    EXPECT_NEAR(kept_by_euler, euler, 1e-3);
    EXPECT_NEAR(kept_by_bdf2, std::pow(bdf2_factor(std::sqrt(g) * h), 10 / h), 1e-5);
    EXPECT_NEAR(kept_by_bdf2, bdf2, 1e-3);
  }
}

TEST(Pendulum, ConvergesInTheOrderOfItsIntegrator) {
  const double euler = angle_error("implicit_euler", 0.005) / angle_error("implicit_euler", 0.0025);
  const double bdf2 = angle_error("bdf2", 0.005) / angle_error("bdf2", 0.0025);
  EXPECT_NEAR(std::log2(euler), 1, 0.1);
  EXPECT_NEAR(std::log2(bdf2), 2, 0.15);
  EXPECT_LT(angle_error("bdf2", 0.005), 0.05 * angle_error("implicit_euler", 0.005));
}

namespace {

/// The error at t = 1 of x'' = -x, x(0) = 1, in steps of `ratio` h and h in turn; an implicit-Euler step from
/// what Integrator gives, solved exactly.
double oscillator_error(double h, double ratio) {
  Integrator integrator(config::Integrator::bdf2);
  State state;
  state.positions = {Vec3(1, 0, 0)};
  state.velocities = {Vec3(0, 0, 0)};
  const double pair = h * (1 + ratio);
  const int pairs = int(std::lround(1 / pair));
  for (int n = 0; n < 2 * pairs; ++n) {
    const double dt = n % 2 == 0 ? ratio * h : h;
    const StepStart start = integrator.start(state, dt);
    const double k = start.dt;
    const Vec3 v = (start.state.velocities[0] - k * start.state.positions[0]) / (1 + k * k);
    const Vec3 x = start.state.positions[0] + k * v;
    EXPECT_NEAR(start.state.time + k, state.time + dt, 1e-15);
    integrator.store_history(state, dt);
    state.positions = {x};
    state.velocities = {v};
    state.time += dt;
  }
  return std::abs(state.positions[0][0] - std::cos(pairs * pair));
}

} // namespace

TEST(Bdf2, IsOfSecondOrderInStepsOfChangingLength) {
  for (const double ratio : {0.5, 1.0, 2.0, 2.3}) {
    const double coarse = oscillator_error(1.0 / (1 + ratio) / 50, ratio),
                 fine = oscillator_error(1.0 / (1 + ratio) / 100, ratio);
    EXPECT_NEAR(std::log2(coarse / fine), 2, 0.15) << "ratio " << ratio;
  }
}

TEST(Bdf2, BeginsAndJumpsWithAnEulerStep) {
  Integrator bdf2(config::Integrator::bdf2), euler(config::Integrator::implicit_euler);
  State state;
  state.positions = {Vec3(1, 2, 3)};
  state.velocities = {Vec3(4, 5, 6)};
  EXPECT_EQ(&bdf2.start(state, 0.1).state, &state); // the first
  bdf2.store_history(state, 0.1);
  EXPECT_EQ(state.previous_dt, 0.1);
  EXPECT_EQ(&bdf2.start(state, 0.25).state, &state); // longer by more than 1 + sqrt 2
  EXPECT_NE(&bdf2.start(state, 0.2).state, &state);
  euler.store_history(state, 0.2);
  EXPECT_EQ(state.previous_dt, 0.1);
}

namespace {

/// Where a sheet that is held by one side and starts tilted is after 0.1 s, sheared and blown at.
Column swung_sheet(const std::string& integrator, double step) {
  Simulation simulation(
      world, case_of(fmt::format("cloth:\n"
                                 "  grid: {{size: [0.5, 0.5], vertices: [5, 5]}}\n"
                                 "  start: {{rotate: {{axis: [1, 4, 0], angle: 30 deg}}}}\n"
                                 "  material: {{bending: 1e-4, shear: 5}}\n"
                                 "air: {{wind: [0, 2, 0]}}\n"
                                 "pins: [{{vertices: [0, 5, 10, 15, 20]}}]\n"
                                 "time: {{end: 0.1, frame_rate: 10, max_step: {}, integrator: {}}}\n"
                                 "inextensibility: {{strain: 1e-9, compliance: 0, solver: mumps}}\n"
                                 "velocity: {{solver: mumps}}\n",
                                 step, integrator)));
  Recorder sheet(simulation);
  run_to_the_end(simulation, sheet);
  return sheet.positions.back();
}

double order_of_sheet(const std::string& integrator) {
  const Column coarse = swung_sheet(integrator, 0.002), middle = swung_sheet(integrator, 0.001),
               fine = swung_sheet(integrator, 0.0005);
  return std::log2((coarse - middle).norm() / (middle - fine).norm());
}

} // namespace

// Shear and drag are linearised with less than their whole derivative.
TEST(Bdf2, IsOfSecondOrderWithShearAndAir) {
  EXPECT_NEAR(order_of_sheet("bdf2"), 2, 0.15);
  EXPECT_NEAR(order_of_sheet("implicit_euler"), 1, 0.15);
}

// Whatever the integrator, a pin is where its keyframes say at the end of each step.
TEST(Bdf2, BringsPinsToTheirPlaces) {
  Simulation simulation(
      world, case_of("cloth: {grid: {size: [0.4, 0.3], vertices: [5, 4]}}\n"
                     "pins: [{vertices: [0], motion: [{time: 0}, {time: 1, translate: [0, 0, 2]}]}]\n"
                     "time: {end: 0.2, frame_rate: 15, max_step: 0.01, integrator: bdf2}\n"));
  Recorder motion(simulation);
  run_to_the_end(simulation, motion);
  double time = 0;
  for (std::size_t n = 0; n < motion.records.size(); ++n) {
    time += motion.records[n].dt;
    EXPECT_NEAR(motion.positions[n + 1][2], 2 * time, 1e-13);
  }
}

TEST(Bdf2, FallsFreelyAsItMust) {
  Simulation simulation(world, case_of("cloth: {grid: {size: [1, 0.8], vertices: [6, 5]}}\n"
                                       "time: {end: 0.1, frame_rate: 10, max_step: 0.01, integrator: bdf2}\n"
                                       "velocity: {solver: mumps}\n"));
  Recorder fall(simulation);
  run_to_the_end(simulation, fall);
  constexpr double h =
      0.01; // after the Euler step, which falls by g h^2 instead of half of it, exact but for v
  double x = -g * h * h, v = -g * h, x_before = 0, v_before = 0;
  for (std::size_t n = 1; n < fall.positions.size(); ++n) {
    EXPECT_NEAR(fall.positions[n][2], x, 1e-12);
    const double next_v = (4 * v - v_before) / 3 - 2 * h / 3 * g;
    const double next_x = (4 * x - x_before) / 3 + 2 * h / 3 * next_v;
    x_before = x, v_before = v, x = next_x, v = next_v;
  }
}

namespace {

/// Velocities of a sheet that falls flat through air, by `step` from velocity to velocity.
template<class Step>
void expect_fall_through_air(const std::string& integrator, Step step) {
  Simulation simulation(world, case_of("cloth: {grid: {size: [0.5, 0.5], vertices: [4, 4]}}\n"
                                       "air: {}\n"
                                       "time: {end: 0.3, frame_rate: 10, max_step: 0.01, integrator: " +
                                       integrator + "}\nvelocity: {solver: mumps}\n"));
  Recorder fall(simulation);
  run_to_the_end(simulation, fall);
  double v = 0, x = 0;
  for (std::size_t n = 1; n < fall.positions.size(); ++n) {
    v = step(v, 0.01);
    x += 0.01 * v;
    for (Global i = 0; i < 16; ++i) EXPECT_NEAR(fall.positions[n][3 * i + 2], x, 1e-11);
  }
  EXPECT_LT(v, -1);
}

constexpr double drag = 1.2 / (2 * 0.2); // rho c / (2 density), 1/m

} // namespace

TEST(Imex, TakesDragFromTheStartOfTheStep) {
  expect_fall_through_air("imex", [](double v, double h) { return v - h * (g + drag * std::abs(v) * v); });
  expect_fall_through_air("implicit_euler",
                          [](double v, double h) { return (v - h * g) / (1 + h * drag * std::abs(v)); });
}
