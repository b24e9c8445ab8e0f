// Coulomb's law contact by contact, in the cases that rub most; they end early and have fewer vertices.
#include "tests/contact/coulomb.hpp"
#include "tests/simulate.hpp"

#include <fmt/format.h>

#include <fstream>
#include <sstream>

namespace taut::test {
namespace {

Case case_in(const std::string& name) {
  const std::string file = fmt::format("{}/cases/{}/case.yaml", TAUT_SOURCE_DIR, name);
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return read_case(text.str(), file);
}

void expect_cones(const Case& input, Global contacts) {
  Simulation simulation(world, input);
  CoulombCheck check(simulation, input);
  run_to_the_end(simulation, check);
  EXPECT_EQ(check.beyond(), 0) << "of " << check.contacts();
  EXPECT_LE(check.largest(), 1.05);
  EXPECT_GT(check.contacts(), contacts);
}

TEST(Coulomb, HoldsOnASphere) {
  Case input = case_in("sphere");
  input.cloths[0].grid->vertices = {31, 31};
  input.time.end = 0.35;
  expect_cones(input, 1000);
}

TEST(Coulomb, HoldsOnAnIncline) {
  Case input = case_in("incline");
  input.time.end = 0.2;
  expect_cones(input, 1000);
}

TEST(Coulomb, HoldsOnATable) {
  Case input = case_in("table");
  input.cloths[0].grid->vertices = {31, 31};
  input.time.end = 0.3;
  expect_cones(input, 1000);
}

TEST(Coulomb, HoldsAroundACapstan) {
  Case input = case_in("capstan");
  input.time.end = 0.1;
  expect_cones(input, 1000);
}

} // namespace
} // namespace taut::test
