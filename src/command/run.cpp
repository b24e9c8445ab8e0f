#include "partition/traffic.hpp"
#include "src/command/carry.hpp"
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

/// The case, begun with the cloth of another run: a pattern is carried there, of anything else the mesh of
/// that run takes its place.
Case begin_from(MPI_Comm comm, const fs::path& folder, CaseSource& source, Case input) {
  const fs::path run = fs::absolute(folder).lexically_normal(), frame = last_frame(comm, run, "--from ");
  auto& cloths = input.cloths;
  if (std::all_of(cloths.begin(), cloths.end(),
                  [](const config::Cloth& c) { return c.pattern.has_value(); })) {
    for (config::Cloth& c : cloths) c.start.run = run;
    return input;
  }
  source.overrides.push_back({"cloth.mesh", (run / run_files::mesh).string()});
  source.overrides.push_back({"cloth.start.shape", frame.string()});
  return load_case(comm, source);
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
  Case input = load_case(comm, options.source);
  if (!options.from.empty()) input = begin_from(comm, options.from, options.source, std::move(input));
  if (options.out.empty()) options.out = std::filesystem::path("out") / input.name;
  const auto& out = options.out;
  if (!options.counters.empty()) try_counters(comm, options.counters, out);
  if (is_carried(input)) return run_carried(comm, input, options, stop, began);
  if (input.sewing) return run_sewing(comm, input, options, stop, began);
  auto simulation = std::make_unique<Simulation>(comm, input);
  try_petsc_options(*simulation, input, options.source.petsc);
  if (!prepare_start(*simulation, input, std::filesystem::path(out) += ".findings.vtp")) return step_failure;
  warn_of_start(*simulation, input);
  make_run_folder(comm, out, input.file);
  const RunLock lock(comm, out);
  clear_run_folder(comm, out, options.existing);
  announce(comm, *simulation, input, out);
  return simulate(comm, input, simulation, {stop, out, options.progress, began, {}, options.counters});
}

} // namespace taut::command
