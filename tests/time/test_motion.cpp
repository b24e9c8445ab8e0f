#include "tests/simulate.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <numbers>
#include <numeric>

using namespace taut;
using namespace taut::test;

namespace {

constexpr double g = 9.81; // m/s^2

} // namespace

TEST(FreeFall, IsThatOfImplicitEuler) {
  for (const std::string solvers : {"velocity: {solver: mumps}\ninextensibility: {solver: mumps}\n",
                                    "velocity: {solver: cg, tolerance: 1e-14}\n"}) {
    Simulation simulation(world, case_of("cloth: {grid: {size: [1, 0.8], vertices: [6, 5]}}\n"
                                         "time: {end: 0.2, frame_rate: 5, max_step: 0.01}\n" +
                                         solvers));
    Recorder fall(simulation);
    run_to_the_end(simulation, fall);
    ASSERT_EQ(fall.records.size(), 20u);
    constexpr double h = 0.01;
    for (int n = 0; n <= 20; ++n)
      for (Eigen::Index i = 0; i < fall.positions[n].size(); ++i) {
        const double drop = i % 3 == 2 ? g * h * h * n * (n + 1) / 2 : 0;
        EXPECT_NEAR(fall.positions[n][i], fall.positions[0][i] - drop, 1e-12); // rounding of positions of 1 m
      }
    for (const StepRecord& r : fall.records) EXPECT_LT(r.strain.max, 1e-12);
  }
}

// Implicit Euler takes an oscillation of the angular velocity w to itself times 1 / (1 +- i w h) in a step,
// hence (1 + w^2 h^2) x'' = 2 x' - x. Both numbers are fitted to the swing of a small angle.
TEST(Pendulum, LosesAsMuchAmplitudeAsImplicitEuler) {
  constexpr double h = 0.01, angle = 1e-3;
  Simulation simulation(world,
                        case_of(fmt::format("cloth:\n"
                                            "  line: {{length: 1, vertices: 2}}\n"
                                            "  start: {{rotate: {{axis: [0, 1, 0], angle: {:.17g}}}}}\n"
                                            "pins: [{{vertices: [0]}}]\n"
                                            "time: {{end: 1.5, frame_rate: 1, max_step: {}}}\n"
                                            "inextensibility: {{strain: 1e-9, compliance: 0}}\n"
                                            "velocity: {{solver: mumps}}\n",
                                            std::numbers::pi / 2 - angle, h)));
  Recorder swing(simulation);
  run_to_the_end(simulation, swing);
  const int steps = int(swing.records.size());
  constexpr int first = 20; // the chain has taken up its tension
  Dense before(steps - first, 2);
  Column after(steps - first);
  for (int n = first; n < steps; ++n) {
    before.row(n - first) << swing.positions[n][3], swing.positions[n - 1][3];
    after[n - first] = swing.positions[n + 1][3];
  }
  const Column fit = before.colPivHouseholderQr().solve(after);
  const double wh2 = g * h * h;
  EXPECT_NEAR((1 + fit[1]) / (wh2 / (1 + wh2)), 1, 0.01);
  EXPECT_NEAR((2 - fit[0]) / (2 * wh2 / (1 + wh2)), 1, 0.01);
}

namespace {

/// A chain of equal links between two points at one height: the links' slopes are tan phi_i = V_i / H with
/// the tension's parts H and V_i = V_0 - (weights of the vertices before link i).
struct Catenary {
  Column depth;   ///< of the vertices, m
  Column tension; ///< of the links, N

  Catenary(int links, double length, double span, double weight) : depth(links + 1), tension(links) {
    const double l = length / links, w = weight / links; // an inner vertex bears half of both its links
    Eigen::Vector2d force(weight / 2, weight / 2);       // H and V_0, by Newton's method
    for (int iteration = 0; iteration < 50; ++iteration) {
      Eigen::Vector2d gap(-span, 0);
      Eigen::Matrix2d slope = Eigen::Matrix2d::Zero();
      for (int i = 0; i < links; ++i) {
        const double h = force[0], v = force[1] - i * w, t = std::hypot(h, v);
        depth[i] = gap[1];
        tension[i] = t;
        gap += l / t * Eigen::Vector2d(h, v);
        slope += l / (t * t * t) * (Eigen::Matrix2d() << v * v, -h * v, -h * v, h * h).finished();
      }
      depth[links] = gap[1];
      force -= slope.inverse() * gap;
    }
  }
};

/// A chain that hangs as a V, as an OBJ file that lives as long as this.
class VShape {
public:
  VShape(int links, double length, double span) : file_(std::filesystem::temp_directory_path() / name()) {
    const double l = length / links, half_span = span / 2,
                 depth = std::sqrt(length * length / 4 - half_span * half_span);
    on_rank_0(world, [&] {
      std::ofstream out(file_);
      for (int i = 0; i <= links; ++i)
        out << fmt::format("v {:.17g} 0 {:.17g}\n", i * l * half_span / (length / 2),
                           -depth * (1 - std::abs(2.0 * i / links - 1)));
      for (int i = 1; i <= links; ++i) out << fmt::format("l {} {}\n", i, i + 1);
    });
  }
  ~VShape() {
    if (rank_of(world) == 0) std::filesystem::remove(file_);
  }
  VShape(const VShape&) = delete;
  std::string path() const { return file_; }

private:
  static std::string name() {
    return broadcast(world, [] { return fmt::format("taut-v-shape-{}.obj", std::random_device()()); });
  }
  std::filesystem::path file_;
};

} // namespace

// The strain of 1e-5 that is allowed makes up to 5e-5 of sag. What is left of the fall after 3 s of damping
// by 10/s is less: exp(-15) = 3e-7.
TEST(HangingChain, IsACatenary) {
  constexpr int links = 80;
  constexpr double length = 1, span = 0.8, density = 0.2;
  const VShape shape(links, length, span);
  Simulation simulation(world,
                        case_of(fmt::format("cloth:\n"
                                            "  line: {{length: {}, vertices: {}}}\n"
                                            "  start: {{shape: {}}}\n"
                                            "  material: {{density: {}, bending: 0, damping: {{mass: 10}}}}\n"
                                            "pins: [{{vertices: [0, {}]}}]\n"
                                            "time: {{end: 3, frame_rate: 1, max_step: 0.01}}\n"
                                            "inextensibility: {{strain: 1e-5, compliance: 0}}\n",
                                            length, links + 1, shape.path(), density, links)));
  Recorder chain(simulation);
  run_to_the_end(simulation, chain);
  const Catenary expected(links, length, span, density * length * g);
  const double sag = expected.depth.maxCoeff();
  const Column& end = chain.positions.back();
  for (int i = 0; i <= links; ++i) EXPECT_NEAR(-end[3 * i + 2], expected.depth[i], 1e-4 * sag);
  const DistributedMesh& mesh = simulation.cloth().mesh;
  const Column q = gather<double>(world, mesh.edges, simulation.state().multipliers.force_density);
  for (int i = 0; i < links; ++i)
    EXPECT_NEAR(q[i] * length / links, expected.tension[i], 1e-3 * expected.tension[i]);
}

// One corner goes around a vertical axis 0.1 m beside it, another one straight inwards and up until it is let
// go.
TEST(Pins, FollowTheirKeyframes) {
  Simulation simulation(
      world,
      case_of(
          "cloth: {grid: {size: [0.4, 0.3], vertices: [5, 4]}}\n"
          "pins:\n"
          "  - vertices: [0]\n"
          "    motion:\n"
          "      - {time: 0}\n"
          "      - {time: 1, rotate: {axis: [0, 0, 1], angle: 2 rad, centre: [-0.1, 0, 0]}}\n"
          "  - {vertices: [4], motion: [{time: 0}, {time: 0.2, translate: [-0.1, 0, 0.1]}], release: 0.1}\n"
          "time: {end: 0.2, frame_rate: 5, max_step: 0.01}\n"));
  Recorder motion(simulation);
  run_to_the_end(simulation, motion);
  ASSERT_EQ(motion.positions.size(), 21u);
  for (int n = 0; n <= 20; ++n) {
    const double t = 0.01 * n;
    const Vec3 turned = motion.positions[n].segment<3>(0), moved = motion.positions[n].segment<3>(3 * 4);
    EXPECT_LT((turned - Vec3(0.1 * std::cos(2 * t) - 0.1, 0.1 * std::sin(2 * t), 0)).norm(), 1e-14);
    const double off = (moved - Vec3(0.4 - 0.5 * t, 0, 0.5 * t)).norm();
    EXPECT_TRUE(n <= 10 ? off < 1e-14 : off > 1e-4) << "at step " << n;
  }
}

namespace {

/// Joules, over all ranks.
double energy_at_start(const Simulation& simulation) {
  double energy = 0;
  for (const auto& force : simulation.forces()) energy += force->energy(simulation.state());
  return sum_over(world, energy);
}

double energy_of(const StepRecord& r) {
  return std::accumulate(r.energies.potential.begin(), r.energies.potential.end(), r.energies.kinetic);
}

} // namespace

TEST(Drape, LosesEnergyInEveryStep) {
  Simulation simulation(world, case_of("cloth:\n"
                                       "  grid: {size: [1, 1], vertices: [11, 11]}\n"
                                       "  material: {bending: 1e-4, damping: {mass: 1, stiffness: 0.01}}\n"
                                       "pins: [{vertices: [0, 10]}]\n"
                                       "time: {end: 1, frame_rate: 1, max_step: 0.01}\n"));
  Recorder drape(simulation);
  const double start = energy_at_start(simulation);
  run_to_the_end(simulation, drape);
  double last = start;
  for (const StepRecord& r : drape.records) {
    const double energy = energy_of(r);
    EXPECT_LE(energy, last);
    last = energy;
  }
  EXPECT_LT(last, start - 0.2 * g * 0.3); // it weighs 0.2 kg, and its middle falls by more than 0.3 m
}

// A weight that falls into a soft thread: where the thread stretches fast, steps grow shorter [BW98 section
// 6].
TEST(StepSize, FollowsHowMuchStretchChanges) {
  const auto stretches = [](const std::string& more) {
    Simulation simulation(
        world, case_of("cloth: {line: {length: 1, vertices: 2}, material: {stretch: 20, density: 0.1}}\n"
                       "pins: [{vertices: [0]}]\n"
                       "gravity: [50, 0, 0]\n"
                       "inextensibility: {method: none}\n"
                       "time: {end: 0.2, frame_rate: 5, max_step: 0.02" +
                       more + "}\n"));
    Recorder fall(simulation);
    run_to_the_end(simulation, fall);
    std::vector<double> lengths;
    for (const Column& x : fall.positions) lengths.push_back(x[3] - x[0]);
    return lengths;
  };
  const auto largest_change = [](const std::vector<double>& lengths) {
    double largest = 0;
    for (std::size_t n = 1; n < lengths.size(); ++n)
      largest = std::max(largest, std::abs(lengths[n] - lengths[n - 1]));
    return largest;
  };
  constexpr double limit = 0.005; // of a rest length of 1 m
  const std::vector<double> coarse = stretches(""), fine = stretches(", max_stretch_change: 0.005");
  EXPECT_EQ(coarse.size(), 11u);
  EXPECT_GT(largest_change(coarse), 2 * limit);
  EXPECT_LE(largest_change(fine), limit);
  EXPECT_GT(fine.size(), coarse.size());
}

// A vertex may belong to nothing that the limit holds for; what is not a number must not pass all the same.
TEST(Acceptance, TakesNothingThatIsNotANumber) {
  const Case input = case_of("cloth: {grid: {size: [1, 1], vertices: [4, 4]}}\n"
                             "time: {max_stretch_change: 0.5}\n");
  const Simulation simulation(world, input);
  const Cloth& cloth = simulation.cloth();
  const State& state = simulation.state();
  Resolved resolved;
  resolved.inextensibility.constrain = config::Constrain::edges;
  resolved.strain_limit = 0.01;
  const Acceptance acceptance(cloth, resolved, 0.5);
  const auto fault_with = [&](auto&& spoil, double strain) {
    Candidate candidate;
    candidate.positions = state.positions;
    candidate.velocities = state.velocities;
    candidate.end_velocities = state.velocities;
    for (std::size_t i = 0; i < state.positions.size(); ++i)
      if (cloth.mesh.vertices.original[i] == 5) spoil(candidate, i);
    return acceptance.fault_of(state, candidate, {strain, 0});
  };
  const double none = std::nan("");
  const auto nothing = [](Candidate&, std::size_t) {};
  EXPECT_EQ(fault_with(nothing, 0.005), "");
  EXPECT_NE(fault_with(nothing, 0.02), "");
  EXPECT_NE(fault_with(nothing, none), "");
  EXPECT_TRUE(acceptance.is_beyond_limit({none, 0}));
  EXPECT_NE(fault_with([&](Candidate& c, std::size_t i) { c.positions[i][2] = none; }, 0.005), "");
  EXPECT_NE(fault_with([&](Candidate& c, std::size_t i) { c.velocities[i][0] = none; }, 0.005), "");
  EXPECT_NE(fault_with([&](Candidate& c, std::size_t i) { c.end_velocities[i][1] = none; }, 0.005), "");
}

// A thread must be able to yield to any strain below the limit, however little compliance it has.
TEST(Compliance, LetsPinsPullThreadsToTheLimit) {
  for (const std::string method : {"fast_projection", "newton"}) {
    Simulation simulation(world, case_of("cloth: {grid: {size: [1, 1], vertices: [9, 9]}}\n"
                                         "pins: [{vertices: [0]}, {vertices: [8], motion: [{time: 0}, "
                                         "{time: 0.1, translate: [0.0095, 0, 0]}]}]\n"
                                         "inextensibility: {method: " +
                                         method +
                                         "}\n"
                                         "time: {end: 0.5, frame_rate: 10, max_step: 0.01}\n"));
    Recorder record(simulation);
    run_to_the_end(simulation, record);
    for (const StepRecord& r : record.records) EXPECT_LE(r.strain.max, 0.01);
  }
}

// Tension grows as steps are halved; if what it stretches grew with it, no step would be short enough.
TEST(Compliance, DoesNotSoftenShortSteps) {
  const std::string yank = "{time: 0}, {time: 0.02, translate: [0, 0, 0.3]}";
  for (const std::string method : {"fast_projection", "newton"}) {
    Simulation simulation(world, case_of("cloth: {grid: {size: [1, 1], vertices: [21, 21]}}\n"
                                         "pins: [{vertices: [0], motion: [" +
                                         yank + "]}, {vertices: [20], motion: [" + yank +
                                         "]}]\n"
                                         "inextensibility: {strain: 0.1 %, method: " +
                                         method +
                                         "}\n"
                                         "time: {end: 0.02, frame_rate: 50, max_step: 0.01}\n"));
    Recorder record(simulation);
    run_to_the_end(simulation, record);
    for (const StepRecord& r : record.records) EXPECT_LE(r.strain.max, 0.001);
  }
}
