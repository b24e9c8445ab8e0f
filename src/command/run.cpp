#include "partition/traffic.hpp"
#include "src/command/run_folder.hpp"
#include "src/command/run_lock.hpp"
#include "src/command/sewing.hpp"
#include "src/command/start_contact.hpp"
#include "src/command/warnings.hpp"
#include "src/output/run_files.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace taut::command {

namespace {

namespace fs = std::filesystem;

/// As `--set` would.
void take_cloth_of(MPI_Comm comm, const fs::path& folder, CaseSource& source) {
  const fs::path run = fs::absolute(folder).lexically_normal();
  const std::string frame = broadcast(comm, [&] {
    std::string last;
    std::error_code none;
    for (const auto& entry : fs::directory_iterator(run / "frames", none))
      if (entry.path().extension() == ".h5") last = std::max(last, entry.path().string());
    if (last.empty()) throw InputError(fmt::format("--from {}: holds no run with frames", folder.string()));
    return last;
  });
  source.overrides.push_back({"cloth.mesh", (run / run_files::mesh).string()});
  source.overrides.push_back({"cloth.start.shape", frame});
}

} // namespace

int run(MPI_Comm comm, const RunOptions& given) {
  const double began = MPI_Wtime();
  const StopSignal stop;
  RunOptions options = given;
  if (!options.counters.empty()) count_traffic();
  if (!options.from.empty()) take_cloth_of(comm, options.from, options.source);
  const Case input = load_case(comm, options.source);
  if (options.out.empty()) options.out = std::filesystem::path("out") / input.name;
  const auto& out = options.out;
  if (input.sewing) return run_sewing(comm, input, options, stop, began);
  Simulation simulation(comm, input);
  try_petsc_options(simulation, input, options.source.petsc);
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
