#include "partition/traffic.hpp"
#include "src/command/run_folder.hpp"
#include "src/command/run_lock.hpp"
#include "src/command/simulate.hpp"
#include "src/command/start_contact.hpp"
#include "src/command/warnings.hpp"

namespace taut::command {

int run(MPI_Comm comm, const RunOptions& options) {
  const double began = MPI_Wtime();
  const StopSignal stop;
  if (!options.counters.empty()) count_traffic();
  const Case input = load_case(comm, options.source);
  Simulation simulation(comm, input);
  try_petsc_options(simulation, input, options.source.petsc);
  const auto out = options.out.empty() ? std::filesystem::path("out") / input.name : options.out;
  if (!clear_start(simulation, input, std::filesystem::path(out) += ".findings.vtp")) return step_failure;
  if (!relax_start(simulation, input)) return step_failure;
  warn_of_start(simulation, input);
  make_run_folder(comm, out, input.file);
  const RunLock lock(comm, out);
  clear_run_folder(comm, out, options.existing);
  announce(comm, simulation, input, out);
  return simulate(comm, input, simulation, {stop, out, options.progress, began, {}, options.counters});
}

} // namespace taut::command
