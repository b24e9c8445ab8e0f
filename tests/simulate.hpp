#pragma once
#include "src/time/simulation.hpp"
#include "tests/support.hpp"

#include <gtest/gtest.h>

namespace taut::test {

inline Case case_of(const std::string& text) { return read_case(text, "cases/test/case.yaml"); }

/// Keeps the whole positions after each step, and what the step was like.
class Recorder : public Observer {
public:
  explicit Recorder(const Simulation& simulation) : mesh_(simulation.cloth().mesh) {
    at_start(simulation.state());
  }

  void at_start(const State& state) override { positions = {whole(state)}; }
  void after_step(const State& state, const StepRecord& record) override {
    positions.push_back(whole(state));
    records.push_back(record);
  }

  std::vector<Column> positions; ///< at the start, then after each step; three rows a vertex
  std::vector<StepRecord> records;

private:
  Column whole(const State& state) const { return gather<Vec3>(mesh_.comm, mesh_.vertices, state.positions); }

  const DistributedMesh& mesh_;
};

/// Runs to the end, which must be reached. Collective.
template<std::derived_from<Observer>... Observers>
void run_to_the_end(Simulation& simulation, Observers&... observers) {
  Observer* const all[] = {&observers...};
  const Outcome outcome = simulation.run(all);
  EXPECT_TRUE(outcome.completed()) << outcome.reason;
}

} // namespace taut::test
