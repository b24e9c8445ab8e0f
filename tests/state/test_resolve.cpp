// What a case leaves to the mesh.
#include "src/state/resolve.hpp"
#include "tests/simulate.hpp"

#include <fmt/format.h>

using namespace taut;
using namespace taut::test;

namespace {

Resolved resolved_with(double gravity) {
  const Case input =
      case_of(fmt::format("cloth: {{grid: {{size: [1, 1], vertices: [5, 5], cells: triangles}}}}\n"
                          "gravity: [0, 0, {}]\n"
                          "time: {{end: 1}}\n",
                          -gravity));
  const Simulation simulation(world, input);
  return resolve(input, simulation.cloth());
}

} // namespace

TEST(Resolve, CompliesWithTheWeightOnEarthWhereGravityIsLess) {
  const Resolved earth = resolved_with(9.80665), twice = resolved_with(2 * 9.80665);
  for (const double gravity : {0.0, 0.9}) {
    const Resolved less = resolved_with(gravity);
    EXPECT_DOUBLE_EQ(*less.inextensibility.compliance, *earth.inextensibility.compliance);
    EXPECT_DOUBLE_EQ(less.stretch[0][0], earth.stretch[0][0]);
  }
  EXPECT_GT(*earth.inextensibility.compliance, 0);
  EXPECT_DOUBLE_EQ(*twice.inextensibility.compliance, 0.5 * *earth.inextensibility.compliance);
  EXPECT_GT(earth.stretch[0][0], 0);
  EXPECT_DOUBLE_EQ(twice.stretch[0][0], 2 * earth.stretch[0][0]);
}
