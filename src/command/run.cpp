#include "partition/traffic.hpp"
#include "src/command/run_folder.hpp"
#include "src/command/sewing.hpp"
#include "src/command/start_contact.hpp"

namespace taut::command {

int run(MPI_Comm comm, const RunOptions& given) {
  const double began = MPI_Wtime();
  RunOptions options = given;
  if (!options.counters.empty()) count_traffic();
  const Case input = load_case(comm, options.source);
  if (options.out.empty()) options.out = std::filesystem::path("out") / input.name;
  const auto& out = options.out;
  if (input.sewing) return run_sewing(comm, input, options, began);
  Simulation simulation(comm, input);
  if (options.source.has_petsc_options) try_petsc_options(simulation);
  if (!clear_start(simulation, input, std::filesystem::path(out) += ".findings.vtp")) return step_failure;
  make_run_folder(comm, out, input.file, options.existing);
  announce(comm, simulation, input, out);
  return simulate(comm, input, simulation, {out, options.progress, began, {}, options.counters});
}

} // namespace taut::command
