#pragma once
#include "src/command/command.hpp"
#include "src/command/stop_signal.hpp"
#include "src/output/checkpoint.hpp"

namespace taut::command {

/// Where a run goes and what it has behind it.
struct RunContext {
  const StopSignal& stop;
  std::filesystem::path out; ///< the folder, ready for this run
  ProgressStyle progress = ProgressStyle::lines;
  double began = 0;                 ///< MPI_Wtime() when the program did
  Totals totals;                    ///< of the run so far
  std::filesystem::path counters{}; ///< as in RunOptions
  std::string case_text{};          ///< what is kept as the case that was run; empty: `input` as it is
  std::filesystem::path whole{};    ///< the run that this one is a stage of, for `taut resume`; empty: `out`
  ContactBalance::Memory balance{}; ///< of the run so far
};

/// The case as YAML, to be run again from anywhere.
std::string case_as_run(Case input);

/// From the present state of `simulation` to the end, with all files of a run; the exit code. On the way the
/// cloth may be cut anew for the ranks; `simulation` is then another one. Collective.
int simulate(MPI_Comm comm, const Case& input, std::unique_ptr<Simulation>& simulation,
             const RunContext& context);

/// Says on standard output what is about to run. Rank 0 speaks.
void announce(MPI_Comm comm, const Simulation& simulation, const Case& input,
              const std::filesystem::path& out);

} // namespace taut::command
