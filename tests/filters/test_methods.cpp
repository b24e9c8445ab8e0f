// Every method and integrator in whole runs: cases/drape at any rank count, a hanging chain, the files.
#include "tests/simulate.hpp"

#include <fmt/format.h>

#include <fstream>
#include <iterator>

using namespace taut;
using namespace taut::test;

namespace {

constexpr double g = 9.81; // m/s^2

struct Choice {
  std::string name, settings;
  bool keeps_limit;
  double tolerance; ///< m, between rank counts
};

const std::vector<Choice> choices{
    {"fast_projection", "", true, 1e-4},
    {"newton", "method: newton, residual: 1e-6", true, 1e-4},
    {"icd", "method: icd", true, 1e-4},
    {"sap", "method: sap", true, 1e-4},
    {"shake", "method: shake", true, 1e-4},
    {"lagged shake", "method: shake, shake: {matrix: lagged}", true, 1e-4},
    {"rattle", "method: rattle", true, 1e-4},
    {"jacobi", "method: jacobi", true, 1e-4},
    {"gauss_seidel", "method: gauss_seidel", true, 1e-4},
    {"budget", "method: gauss_seidel, limiting: {max_sweeps: 4, must_reach_limit: false}", false, 1e-4},
    {"xpbd", "method: xpbd, xpbd: {substeps: 30}", false, 0},
    {"springs", "method: springs, springs: {stiffness: 3000}", false,
     0.05}, // round-off tells how flat springs buckle
};

std::string text_of(const std::filesystem::path& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// cases/drape on a coarser grid, its first 0.06 s.
Case drape(const std::string& method, const std::string& integrator = "implicit_euler") {
  const std::filesystem::path file = std::filesystem::path(TAUT_SOURCE_DIR) / "cases/drape/case.yaml";
  std::vector<Override> set{{"cloth.grid.vertices", "[17, 17]"},
                            {"pins.1.vertices", "[16]"},
                            {"time.end", "0.06"},
                            {"time.max_step", "6 ms"},
                            {"time.integrator", integrator},
                            {"velocity.tolerance", "1e-11"}}; // folds magnify differences
  set.push_back({"inextensibility", "{strain: 1 %" + (method.empty() ? "" : ", " + method) + "}"});
  return read_case(text_of(file), file.string(), set);
}

struct Trip {
  Column positions;
  double strain = 0;
  Global iterations = 0;
};

Trip run(MPI_Comm comm, const Case& input) {
  class Watch : public Observer {
  public:
    void after_step(const State&, const StepRecord& r) override {
      strain = std::max(strain, r.strain.max);
      iterations += r.counts.iterations;
    }
    double strain = 0;
    Global iterations = 0;
  } watch;
  Simulation simulation(comm, input);
  Observer* const observers[] = {&watch};
  const Outcome outcome = simulation.run(observers);
  EXPECT_TRUE(outcome.completed()) << outcome.reason;
  return {gather<Vec3>(comm, simulation.cloth().mesh.vertices, simulation.state().positions), watch.strain,
          watch.iterations};
}

/// The trip on one rank alone, told to all.
Trip serial_run(const Case& input) {
  Trip alone{Column::Zero(3 * 17 * 17)};
  if (rank_of(world) == 0) alone = run(self, input);
  sum_in_place(world, {alone.positions.data(), std::size_t(alone.positions.size())});
  alone.strain = sum_over(world, alone.strain);
  alone.iterations = sum_over(world, alone.iterations);
  return alone;
}

double farthest(const Column& a, const Column& b) {
  return (a - b).reshaped(3, a.size() / 3).colwise().norm().maxCoeff();
}

} // namespace

// The pins push a flat sheet together: how it buckles is not the same for all methods, how far it falls is.
TEST(Methods, DrapeTheSameAtAnyRankCountAndAgreeOnTheFall) {
  constexpr double fall = -g * 0.06 * 0.066 / 2; // 10 steps of implicit Euler
  double fall_of_first = fall;
  for (const Choice& choice : choices) {
    SCOPED_TRACE(choice.name);
    const Case input = drape(choice.settings);
    const Trip alone = serial_run(input), found = run(world, input);
    EXPECT_LE(farthest(found.positions, alone.positions), choice.tolerance);
    EXPECT_GT(found.strain, 0);
    if (choice.keeps_limit) {
      EXPECT_LE(found.strain, 0.01);
    }
    EXPECT_EQ(found.iterations > 0, choice.name != "springs");
    const double height = found.positions.reshaped(3, 17 * 17).row(2).mean();
    if (&choice == &choices.front()) fall_of_first = height;
    EXPECT_NEAR(fall_of_first, fall, 1e-3);
    EXPECT_NEAR(height, fall_of_first, 3e-3);
  }
}

TEST(Methods, TakeEveryIntegrator) {
  for (const std::string integrator : {"bdf2", "imex"})
    for (const std::string method : {"", "method: newton, residual: 1e-6", "method: icd", "method: shake",
                                     "method: rattle", "method: gauss_seidel"}) {
      SCOPED_TRACE(integrator + " " + method);
      const Case input = drape(method, integrator);
      const Trip alone = serial_run(input), found = run(world, input);
      EXPECT_LE(farthest(found.positions, alone.positions), 1e-4);
      EXPECT_LE(found.strain, 0.01);
    }
}

TEST(Xpbd, ComesCloserToInextensibleWithItsSubsteps) {
  const auto strain = [](int substeps) {
    return run(world, drape(fmt::format("method: xpbd, xpbd: {{substeps: {}}}", substeps))).strain;
  };
  EXPECT_LT(strain(80), 0.5 * strain(20));
}

namespace {

/// A chain of 8 links hanging from its end, at rest: link i bears what hangs below it.
struct Hanging {
  Column positions, tension;
  double weight_of_link;
};

Hanging hang(const std::string& settings, double strain) {
  Simulation simulation(world, case_of("cloth:\n"
                                       "  line: {length: 0.8, vertices: 9}\n"
                                       "  start: {rotate: {axis: [0, 1, 0], angle: 1.4}}\n"
                                       "  material: {density: 0.2, bending: 0, damping: {mass: 8}}\n"
                                       "pins: [{vertices: [0]}]\n"
                                       "time: {end: 2, frame_rate: 1, max_step: 0.01}\n"
                                       "inextensibility: {strain: " +
                                       fmt::format("{}", strain) + (settings.empty() ? "" : ", " + settings) +
                                       "}\n"));
  const Outcome outcome = simulation.run({});
  EXPECT_TRUE(outcome.completed()) << outcome.reason;
  const DistributedMesh& mesh = simulation.cloth().mesh;
  return {gather<Vec3>(world, mesh.vertices, simulation.state().positions),
          gather<double>(world, mesh.edges, simulation.state().multipliers.force_density) * 0.1,
          0.2 * 0.1 * g};
}

} // namespace

// Sweeps leave tensions as far off as strains: they are given a strict limit.
TEST(Methods, HangAChainStraightAndKnowItsTensions) {
  for (const Choice& choice : choices) {
    if (choice.name == "budget") continue;
    SCOPED_TRACE(choice.name);
    const Hanging found =
        hang(choice.settings, choice.name == "jacobi" || choice.name == "gauss_seidel" ? 1e-7 : 1e-3);
    for (int i = 0; i <= 8; ++i)
      EXPECT_NEAR(found.positions[3 * i + 2], -0.1 * i, 2e-3); // the limit, or what springs give
    for (int link = 0; link < 8; ++link)
      EXPECT_NEAR(found.tension[link], (7.5 - link) * found.weight_of_link,
                  0.03 * 7.5 * found.weight_of_link);
  }
}

TEST(Springs, StretchByTheirTensionOverTheirStiffness) {
  for (const double stiffness : {100.0, 1000.0}) {
    const Hanging found = hang(fmt::format("method: springs, springs: {{stiffness: {}}}", stiffness), 0.01);
    for (int link = 0; link < 8; ++link) {
      const double strain = (found.positions[3 * link + 2] - found.positions[3 * link + 5]) / 0.1 - 1,
                   tension = (7.5 - link) * found.weight_of_link;
      EXPECT_NEAR(strain, tension / stiffness, 0.01 * 7.5 * found.weight_of_link / stiffness);
    }
  }
}
