#pragma once
// Runs on some of the ranks, cut at a step and gone on with on others.
#include "src/output/checkpoint.hpp"
#include "src/output/checkpoint_cut.hpp"
#include "tests/simulate.hpp"

#include <filesystem>

namespace taut::test {

/// What is compared of two runs.
struct Result {
  Column positions, velocities, force_densities; ///< at the end
  Global steps = 0, rejected = 0;
};

inline Result result_of(const Simulation& simulation) {
  const DistributedMesh& mesh = simulation.cloth().mesh;
  const State& s = simulation.state();
  return {gather<Vec3>(mesh.comm, mesh.vertices, s.positions),
          gather<Vec3>(mesh.comm, mesh.vertices, s.velocities),
          gather<double>(mesh.comm, mesh.edges, s.multipliers.force_density), s.step,
          simulation.rejected_steps()};
}

/// The first `ranks` ranks of all; MPI_COMM_NULL on the others.
class Some {
public:
  explicit Some(int ranks) {
    MPI_Comm_split(world, rank_of(world) < ranks ? 0 : MPI_UNDEFINED, rank_of(world), &comm_);
  }
  ~Some() {
    if (comm_ != MPI_COMM_NULL) MPI_Comm_free(&comm_);
    MPI_Barrier(world);
  }
  Some(const Some&) = delete;

  template<class Work>
  void do_it(Work&& work) const {
    if (comm_ != MPI_COMM_NULL) work(comm_);
  }

private:
  MPI_Comm comm_ = MPI_COMM_NULL;
};

inline Checkpoint checkpoint_of(const Simulation& simulation) {
  return {"", simulation.state(), simulation.step_size().memory(), simulation.rejected_steps(), {}};
}

/// To the end on the first `ranks` ranks; the result is on the first.
inline Result run_whole(const std::string& text, int ranks) {
  Result result;
  Some(ranks).do_it([&](MPI_Comm comm) {
    Simulation simulation(comm, case_of(text));
    EXPECT_TRUE(simulation.run({}).completed());
    result = result_of(simulation);
  });
  return result;
}

/// On the first `ranks` ranks until `steps` are done, which leaves a checkpoint.
inline void run_and_cut(const std::string& text, int ranks, Global steps, const std::filesystem::path& file) {
  Some(ranks).do_it([&](MPI_Comm comm) {
    Simulation simulation(comm, case_of(text));
    EXPECT_EQ(simulation.run({}, [&] { return simulation.state().step == steps; }).ending,
              Ending::interrupted);
    EXPECT_EQ(simulation.state().step, steps);
    write_checkpoint(file, simulation.cloth().mesh, checkpoint_of(simulation));
  });
}

/// From a checkpoint to the end on the first `ranks` ranks, the state first changed; the result is on the
/// first.
inline Result go_on(
    const std::string& text, int ranks, const std::filesystem::path& file,
    const std::function<void(State&)>& change = [](State&) {}) {
  Result result;
  Some(ranks).do_it([&](MPI_Comm comm) {
    Simulation simulation(comm, case_of(text), cut_of_checkpoint(file));
    Checkpoint c = read_checkpoint(file, simulation.cloth().mesh);
    change(c.state);
    simulation.restore(std::move(c.state), c.step_size, c.rejected_steps);
    EXPECT_TRUE(simulation.run({}).completed());
    result = result_of(simulation);
  });
  return result;
}

/// The largest distance between where two runs end, m.
inline double distance(const Result& a, const Result& b) {
  return (a.positions - b.positions).reshaped(3, a.positions.size() / 3).colwise().norm().maxCoeff();
}

} // namespace taut::test
