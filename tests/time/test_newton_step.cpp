// Newton's method on the whole step: cloth that hangs comes to rest at long steps.
#include "tests/simulate.hpp"

#include <fmt/format.h>

using namespace taut;
using namespace taut::test;

namespace {

/// Hung by two corners that come closer by a tenth.
std::string hanging(const std::string& cells, double end, double step) {
  return fmt::format("cloth:\n"
                     "  grid: {{size: [0.3, 0.3], vertices: [11, 11], cells: {}}}\n"
                     "  material: {{density: 0.2, bending: 1e-5, shear: 10, damping: {{mass: 1}}}}\n"
                     "pins:\n"
                     "  - vertices: [0]\n"
                     "    motion: [{{time: 0}}, {{time: 0.3, translate: [0.015, 0, 0]}}]\n"
                     "  - vertices: [10]\n"
                     "    motion: [{{time: 0}}, {{time: 0.3, translate: [-0.015, 0, 0]}}]\n"
                     "time: {{end: {}, frame_rate: 1, max_step: {}}}\n"
                     "inextensibility: {{method: newton}}\n",
                     cells, end, step);
}

struct Hung {
  std::vector<double> kinetic; ///< J, after each step
  std::vector<double> depth;   ///< m
  double strain = 0;
  Vec3 pull = Vec3::Zero(); ///< N, of both pins, at the end
};

Hung hang(const std::string& text) {
  Simulation simulation(world, case_of(text));
  Recorder recorder(simulation);
  run_to_the_end(simulation, recorder);
  Hung result;
  for (const StepRecord& r : recorder.records) {
    result.kinetic.push_back(r.energies.kinetic);
    result.depth.push_back(r.depth);
    result.strain = std::max(result.strain, r.strain.max);
  }
  for (const Vec3& f : recorder.records.back().pin_forces) result.pull += f;
  return result;
}

constexpr double weight = 0.2 * 0.3 * 0.3 * 9.81; // N

} // namespace

// A prediction and a projection in the metric of masses leave it at 0.2 m/s for ever.
TEST(NewtonStep, ComesToRestAtLongSteps) {
  const Hung hung = hang(hanging("quads", 10, 0.01));
  EXPECT_LE(hung.strain, 0.01);
  EXPECT_LT(hung.kinetic.back(), 1e-6 * weight * 0.3);
  EXPECT_LT(hung.kinetic.back(), 0.1 * hung.kinetic[hung.kinetic.size() / 2]);
  EXPECT_NEAR(hung.pull[2], weight, 0.01 * weight);
  EXPECT_LT(hung.pull.head<2>().norm(), 0.01 * weight);
}

TEST(NewtonStep, ComesToRestWithTriangles) {
  const Hung hung = hang(hanging("alternating_triangles", 10, 0.01));
  EXPECT_LE(hung.strain, 0.01);
  EXPECT_LT(hung.kinetic.back(), 1e-6 * weight * 0.3);
  EXPECT_NEAR(hung.pull[2], weight, 0.01 * weight);
}

TEST(NewtonStep, HangsAsDeepWhateverTheStep) {
  const double deep = hang(hanging("quads", 6, 0.01)).depth.back();
  EXPECT_NEAR(hang(hanging("quads", 6, 0.005)).depth.back(), deep, 0.01 * deep);
}
