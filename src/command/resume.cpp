#include "io/hdf5.hpp"
#include "src/command/arrival.hpp"
#include "src/command/run_folder.hpp"
#include "src/command/run_lock.hpp"
#include "src/command/sewing.hpp"
#include "src/command/start_contact.hpp"
#include "src/config/changes.hpp"
#include "src/output/checkpoint.hpp"
#include "src/output/checkpoint_cut.hpp"
#include "src/output/run_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <sstream>

namespace taut::command {

namespace {

namespace fs = std::filesystem;

/// What a resumed run cannot change: the key and all below it, "*" being any entry of a list.
struct FixedKey {
  const char* key;
  const char* why;
};

constexpr std::array fixed_keys{
    FixedKey{"cloth.grid", "the state belongs to its vertices"},
    FixedKey{"cloth.line", "the state belongs to its vertices"},
    FixedKey{"cloth.edge", "the state belongs to its vertices"},
    FixedKey{"cloth.panels.*.edge", "the state belongs to its vertices"},
    FixedKey{"cloth.scale", "the state belongs to the mesh as it was scaled"},
    FixedKey{"cloth.start", "the run has left its start already"},
    FixedKey{"cloths.*.grid", "the state belongs to its vertices"},
    FixedKey{"cloths.*.line", "the state belongs to its vertices"},
    FixedKey{"cloths.*.edge", "the state belongs to its vertices"},
    FixedKey{"cloths.*.panels.*.edge", "the state belongs to its vertices"},
    FixedKey{"cloths.*.scale", "the state belongs to the mesh as it was scaled"},
    FixedKey{"cloths.*.start", "the run has left its start already"},
    FixedKey{"pins.*.cloth", "a vertex pinned on the way would jump back to its start"},
    FixedKey{"pins.*.range", "a vertex pinned on the way would jump back to its start"},
    FixedKey{"pins.*.vertices", "a vertex pinned on the way would jump back to its start"},
    FixedKey{"pins.*.box", "a vertex pinned on the way would jump back to its start"},
    FixedKey{"pins.*.near", "a vertex pinned on the way would jump back to its start"},
    FixedKey{"time.frame_rate", "frames are numbered by it"},
};

/// "pins.0.box.min" is below "pins.*.box".
bool is_below(const std::string& key, const std::string& fixed) {
  std::istringstream in(key), wanted(fixed);
  for (std::string part, pattern; std::getline(wanted, pattern, '.');)
    if (!std::getline(in, part, '.') || (pattern != "*" && pattern != part)) return false;
  return true;
}

std::string shortened(const std::string& text) {
  constexpr std::size_t longest = 60;
  return text.size() <= longest ? text : text.substr(0, longest) + "...";
}

constexpr std::array file_keys{"cloth.mesh",    "cloth.pattern",    "cloth.start.shape",
                               "cloths.*.mesh", "cloths.*.pattern", "cloths.*.start.shape"};

/// Says what is new since the checkpoint; throws for what must stay. A mesh may lie elsewhere now.
void tell_changes(MPI_Comm comm, const Case& before, const Case& after) {
  for (const KeyChange& c : changes_between(before, after)) {
    if (std::any_of(file_keys.begin(), file_keys.end(),
                    [&](const char* key) { return is_below(c.key, key); }))
      continue;
    for (const FixedKey& fixed : fixed_keys)
      if (is_below(c.key, fixed.key))
        throw InputError(fmt::format("{}: {} was {} and is {} now, but a resumed run cannot change it: {}; "
                                     "leave it as it was, or start a new run",
                                     after.file.string(), c.key, shortened(c.before), shortened(c.after),
                                     fixed.why));
    if (rank_of(comm) == 0)
      fmt::print("changed: {}: {} -> {}\n", c.key, shortened(c.before), shortened(c.after));
  }
}

/// The mesh of the run, as it was written when it began, must be the one that is there now. Without a sound
/// file of it the run can go on, but not be compared.
void check_mesh(const Cloth& cloth, const fs::path& path) {
  const DistributedMesh& mesh = cloth.mesh;
  if (const std::string damage = damage_of(mesh.comm, path, Checksum::required); !damage.empty()) {
    if (rank_of(mesh.comm) == 0)
      fmt::print(stderr,
                 "taut: warning: {}; it is written anew, but whether the mesh of the case is still that "
                 "of the run could not be checked\n",
                 damage);
    return;
  }
  const H5Reader file(mesh.comm, path);
  const Slab vertices = mesh.vertex_order.slab(), edges = mesh.edge_order.slab();
  const auto differs = [&](const char* dataset, const std::string& what) {
    return InputError(fmt::format("{}: {}: the mesh of the run {} than the mesh of the case has now; put the "
                                  "mesh back as it was, or start a new run",
                                  path.string(), dataset, what));
  };
  if (file.rows("/rest_positions") != vertices.total)
    throw differs("/rest_positions", "has another number of vertices");
  if (file.rows("/constraints/rest_lengths") != edges.total)
    throw differs("/constraints/rest_lengths", "has another number of edges");
  const auto then = file.read_vectors("/rest_positions", vertices);
  const auto now = mesh.vertex_order.to_slab<Vec3>(mesh.rest_positions);
  bool moved = false;
  for (std::size_t i = 0; i < now.size(); ++i)
    moved |= (then[i] - now[i]).norm() > 1e-9 * (1 + now[i].norm());
  if (any_of(mesh.comm, moved)) throw differs("/rest_positions", "has vertices in other places");
}

/// The checkpoints of a run in `out` to try, in turn.
std::vector<fs::path> candidates(MPI_Comm comm, const ResumeOptions& options, const fs::path& out) {
  if (!options.checkpoint.empty()) return {options.checkpoint};
  const std::string names = broadcast(comm, [&] {
    std::string lines;
    for (const fs::path& file : checkpoints_in(out)) lines += file.string() + "\n";
    return lines;
  });
  std::vector<fs::path> files;
  std::istringstream in(names);
  for (std::string line; std::getline(in, line);) files.emplace_back(line);
  return files;
}

/// The case of the latest checkpoint that has one to read.
std::optional<Case> case_before(MPI_Comm comm, const std::vector<fs::path>& files, const Case& now) {
  for (const fs::path& file : files) {
    try {
      return read_case(read_case_of_checkpoint(comm, file), now.file.string());
    } catch (const InputError&) { // on all ranks alike; `latest` will tell
    }
  }
  return std::nullopt;
}

/// A checkpoint whose pinned vertices are where the case puts them.
Checkpoint read_of(const Simulation& simulation, const fs::path& file) {
  Checkpoint checkpoint = read_checkpoint(file, simulation.cloth().mesh);
  if (const auto jump = simulation.pins().find_jump(simulation.cloth(), checkpoint.state))
    throw InputError(fmt::format("{}: {}; a motion must go on from where it was, and the checkpoint be of "
                                 "this case",
                                 file.string(), *jump));
  return checkpoint;
}

/// As the latest checkpoint was cut that can be read, or anew if the case wants it otherwise now; `latest`
/// tells of the others.
Cut cut_of(const std::vector<fs::path>& files, const config::Partition& before) {
  return [files, before](MPI_Comm comm, const UndistributedCloth& cloth, const Case& input) {
    const bool is_as_before = input.partition == before;
    for (const fs::path& file : files) {
      try {
        return (is_as_before ? cut_of_checkpoint(file) : cut_by_checkpoint(file))(comm, cloth, input);
      } catch (const InputError&) { // on all ranks alike
      }
    }
    return cut_at_start(comm, cloth, input);
  };
}

/// The latest checkpoint that can be read, with a word on those that cannot.
Checkpoint latest(const Simulation& simulation, const std::vector<fs::path>& files) {
  const DistributedMesh& mesh = simulation.cloth().mesh;
  for (std::size_t k = 0;; ++k) {
    try {
      return read_of(simulation, files[k]);
    } catch (const InputError& e) { // on all ranks alike
      if (k + 1 == files.size()) throw;
      if (rank_of(mesh.comm) == 0)
        fmt::print(stderr, "taut: {}; going back to {}\n", e.what(), files[k + 1].string());
    }
  }
}

/// Puts the simulation where the latest sound checkpoint is; the checkpoint, without its state.
Checkpoint take_up(Simulation& simulation, const std::vector<fs::path>& files) {
  const DistributedMesh& mesh = simulation.cloth().mesh;
  Checkpoint checkpoint = latest(simulation, files);
  simulation.restore(std::move(checkpoint.state), checkpoint.step_size, checkpoint.rejected_steps);
  if (rank_of(mesh.comm) == 0)
    fmt::print("resuming at t = {:.6g} s, after step {}\n", simulation.state().time, simulation.state().step);
  return checkpoint;
}

void check_folder(MPI_Comm comm, const fs::path& folder) {
  on_rank_0(comm, [&] {
    if (!fs::is_regular_file(folder / run_files::case_as_run))
      throw InputError(fmt::format("{}: holds no run (no case.yaml); start one with taut run CASE --out {}",
                                   folder.string(), folder.string()));
  });
}

/// The stage of sewing that a run is in: it has nothing of those that come after it. None if it is past all.
/// Collective.
std::optional<SewingStage> stage_of(MPI_Comm comm, const fs::path& folder) {
  const auto has_begun = [&](const fs::path& stage) {
    std::error_code ignored;
    return any_of(comm, rank_of(comm) == 0 && fs::exists(stage / run_files::case_as_run, ignored));
  };
  if (has_begun(folder)) return std::nullopt;
  for (const SewingStage stage : {SewingStage::fitting, SewingStage::sewing})
    if (has_begun(folder_of(stage, folder))) return stage;
  return std::nullopt;
}

/// Whether the folder has all that a run writes when it has ended: the summary is the last of it. Collective.
bool has_ended(MPI_Comm comm, const fs::path& folder) {
  std::error_code ignored;
  return any_of(comm, rank_of(comm) == 0 && fs::exists(folder / run_files::summary, ignored));
}

} // namespace

int resume(MPI_Comm comm, const ResumeOptions& options) {
  const double began = MPI_Wtime();
  const StopSignal stop;
  const std::optional<SewingStage> before = stage_of(comm, options.folder);
  const fs::path out = before ? folder_of(*before, options.folder) : options.folder;
  check_folder(comm, out);
  const RunLock lock(comm, options.folder); // both stages
  const Case input = load_case(comm, {out / run_files::case_as_run, options.overrides, options.petsc});
  const std::vector<fs::path> checkpoints = candidates(comm, options, out);
  const auto then = case_before(comm, checkpoints, input);
  if (then) tell_changes(comm, *then, input);
  const Case stage = before ? case_of(*before, input, options.folder) : input;
  auto simulation =
      std::make_unique<Simulation>(comm, stage, cut_of(checkpoints, then.value_or(input).partition));
  Checkpoint before_this;
  if (!checkpoints.empty()) {
    check_mesh(simulation->cloth(), out / run_files::mesh);
    before_this = take_up(*simulation, checkpoints);
  } else if (rank_of(comm) == 0) {
    fmt::print("{}: the run was cut off before its first checkpoint: it begins anew\n", out.string());
  }
  const auto clear = [&] {
    return before ? clear_stage(*before, *simulation, stage, options.folder)
                  : prepare_start(*simulation, stage, out / run_files::findings);
  };
  if (checkpoints.empty() && !clear()) return step_failure;
  const State& state = simulation->state();
  const Global next_frame = simulation->step_size().frame_after(state.time);
  const bool is_over = next_frame > simulation->step_size().frames() || has_arrived(stage, *simulation);
  if (is_over && has_ended(comm, out) && !before) {
    if (rank_of(comm) == 0)
      fmt::print("{}: the run is complete: it has reached its end at {:g} s; go on further with --set "
                 "time.end=...\n",
                 out.string(), state.time);
    return success;
  }
  try_petsc_options(*simulation, input, options.petsc);
  drop_after(comm, out, state.step, state.step > 0 ? next_frame : 0);
  announce(comm, *simulation, stage, out);
  const int code = simulate(comm, stage, simulation,
                            {stop,
                             out,
                             options.progress,
                             began,
                             std::move(before_this.totals),
                             {},
                             case_as_run(input),
                             options.folder,
                             before_this.balance});
  if (!before || code != success) return code;
  const CaseSource source{out / run_files::case_as_run, options.overrides, options.petsc};
  return run_after(*before, comm, input, *simulation,
                   {source, options.folder, ExistingRun::overwrite, options.progress, {}, {}}, stop, began);
}

} // namespace taut::command
