#include "partition/traffic.hpp"
#include "src/command/run_folder.hpp"
#include "src/command/run_lock.hpp"
#include "src/command/sewing.hpp"
#include "src/command/start_contact.hpp"
#include "src/command/warnings.hpp"
#include "src/output/run_files.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

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

/// Before a run that may take days, not after it. What lies in `out` comes to be with it.
void try_counters(MPI_Comm comm, const fs::path& file, const fs::path& out) {
  on_rank_0(comm, [&] {
    const fs::path folder = fs::absolute(file).lexically_normal().parent_path();
    std::error_code none;
    const bool is_folder = fs::is_directory(file, none);
    if (!is_folder && folder == fs::absolute(out).lexically_normal()) return;
    if (is_folder || access(folder.c_str(), W_OK | X_OK) != 0)
      throw InputError(
          fmt::format("--counters {}: cannot be written: {}; give a file in a folder that exists "
                      "and may be written to",
                      file.string(), is_folder ? "it is a folder" : std::strerror(errno)));
  });
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
  if (!options.counters.empty()) try_counters(comm, options.counters, out);
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
