#include "io/whole_file.hpp"
#include "src/command/command.hpp"
#include "src/time/frame_writer.hpp"
#include "src/time/intersection_check.hpp"
#include "src/time/simulation.hpp"
#include "src/time/step_log.hpp"
#include "src/time/summary.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

namespace taut::command {

namespace {

namespace fs = std::filesystem;

constexpr std::array results{"mesh.h5", "frames.xdmf", "edges.xdmf", "steps.csv", "summary.json"};

bool holds_run(const fs::path& out) {
  return std::any_of(results.begin(), results.end(),
                     [&](const char* file) { return fs::exists(out / file); });
}

/// Removes what a run wrote and nothing else.
void remove_run(const fs::path& out) {
  for (const char* file : results) fs::remove(out / file);
  fs::remove(out / "case.yaml");
  if (!fs::is_directory(out / "frames")) return;
  for (const auto& entry : fs::directory_iterator(out / "frames"))
    if (entry.path().filename().string().starts_with("frame_")) fs::remove(entry.path());
}

/// Makes the folder ready for a new run, on rank 0.
void prepare(const fs::path& out, const fs::path& case_file, ExistingRun existing) {
  if (fs::exists(out) && fs::equivalent(out, fs::absolute(case_file).parent_path()))
    throw InputError(
        fmt::format("{}: the case file lies in this folder and would be replaced by the case as run; choose "
                    "another folder with --out",
                    out.string()));
  if (holds_run(out)) {
    if (existing == ExistingRun::refuse)
      throw InputError(fmt::format("{}: this folder holds a run already; choose another with --out, or give "
                                   "--overwrite to replace that run",
                                   out.string()));
    remove_run(out);
  }
  fs::create_directories(out / "frames");
}

fs::path output_folder(MPI_Comm comm, const RunOptions& options, const Case& input) {
  const fs::path out = options.out.empty() ? fs::path("out") / input.name : options.out;
  broadcast(comm, [&] {
    try {
      prepare(out, input.file, options.existing);
    } catch (const fs::filesystem_error& e) {
      throw InputError(fmt::format("{}: cannot be written: {}; choose another folder with --out",
                                   out.string(), e.code().message()));
    }
    return std::string();
  });
  return out;
}

/// The case as run, to be run again from anywhere.
std::string case_as_run(Case input) {
  for (auto* path : {&input.cloth.mesh, &input.cloth.start.shape})
    if (*path) *path = fs::absolute(input.folder() / **path).lexically_normal();
  return write_case(input);
}

std::vector<std::string> potential_names(const Forces& forces) {
  std::vector<std::string> names;
  for (const auto& force : forces) names.emplace_back(force->name());
  return names;
}

void announce(MPI_Comm comm, const Simulation& simulation, const Case& input, const fs::path& out) {
  const DistributedMesh& mesh = simulation.cloth().mesh;
  if (rank_of(comm) != 0) return;
  fmt::print("{}: {} vertices, {} constrained edges, {} pinned, {} frames, on {} ranks ({} edges cut, "
             "imbalance {:.3f})\n"
             "writing {}\n",
             input.name, mesh.vertices.total, mesh.edges.total, simulation.pins().count(),
             simulation.step_size().frames(), size_of(comm), mesh.report.edge_cut, mesh.report.imbalance,
             (out / "frames.xdmf").string());
  std::fflush(stdout);
}

} // namespace

int run(MPI_Comm comm, const RunOptions& options) {
  const double began = MPI_Wtime();
  const Case input = load_case(comm, options.source);
  Simulation simulation(comm, input);
  if (options.source.has_petsc_options) try_petsc_options(simulation);
  IntersectionCheck intersections(simulation.cloth(), input);
  if (input.has_contact()) intersections.refuse(simulation.state());
  const fs::path out = output_folder(comm, options, input);
  write_text_whole(comm, out / "case.yaml", case_as_run(input));
  announce(comm, simulation, input, out);

  FrameWriter frames(simulation.cloth(), input.output.fields, out);
  StepLog log(comm, out / "steps.csv", potential_names(simulation.forces()));
  Progress progress(comm, options.progress, simulation.step_size().frames(), input.time.end);
  Summary summary(simulation, input, MPI_Wtime() - began);
  std::vector<Observer*> observers{&frames, &log, &progress, &summary};
  if (input.has_contact()) observers.push_back(&intersections);
  Outcome outcome = simulation.run(observers);

  if (outcome.completed && intersections.count() > 0) {
    outcome.completed = false;
    outcome.reason = fmt::format("{} intersections were found in the result; the first: {}",
                                 intersections.count(), intersections.first());
  }
  write_text_whole(comm, out / "summary.json",
                   summary.text(outcome, frames.frames(), intersections.count(), frames.seconds()));
  if (outcome.completed) return success;
  if (rank_of(comm) == 0) fmt::print(stderr, "taut: {}\n", outcome.reason);
  return step_failure;
}

} // namespace taut::command
