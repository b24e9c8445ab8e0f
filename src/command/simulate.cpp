#include "src/command/simulate.hpp"

#include "io/whole_file.hpp"
#include "src/command/arrival.hpp"
#include "src/command/counters.hpp"
#include "src/output/checkpoint_cut.hpp"
#include "src/output/checkpointer.hpp"
#include "src/output/frame_formats.hpp"
#include "src/output/frame_writer.hpp"
#include "src/output/run_files.hpp"
#include "src/output/step_log.hpp"
#include "src/time/make_forces.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdio>

namespace taut::command {

namespace {

namespace fs = std::filesystem;

int exit_code(Ending ending) {
  switch (ending) {
  case Ending::completed:
    return success;
  case Ending::interrupted:
    return interrupted;
  case Ending::failed:
    return step_failure;
  }
  return internal_error;
}

void tell_of_bodies(MPI_Comm comm, const Case& input, const Obstacles& obstacles) {
  if (rank_of(comm) != 0) return;
  for (int k = 0; k < int(input.obstacles.size()); ++k) {
    const Obstacles::Body& body = obstacles.body(k);
    if (body.rims > 0 && input.obstacles[k].mesh)
      fmt::print("{}: its mesh is open along {} edges; both sides of it collide\n", body.name, body.rims);
    if (body.yielding > 0)
      fmt::print(
          "{}: {} of its vertices give way by up to {:.3g} mm, so that {:.3g} mm are left between parts "
          "of it (obstacles[].room)\n",
          body.name, body.yielding, 1000 * body.yields, 1000 * *input.obstacles[k].room);
  }
}

/// What came out, and where it is.
void report_success(MPI_Comm comm, const Case& input, const Simulation& simulation, const Totals& totals,
                    const fs::path& out) {
  const bool moves = input.time.until_rest && !has_arrived(input, simulation); // collective
  if (rank_of(comm) != 0) return;
  const std::string limit = simulation.strain_limit()
                                ? fmt::format("the limit is {:.3g} %", 100 * *simulation.strain_limit())
                                : "no limit is kept";
  fmt::print("{}: {:.6g} s in {} steps ({} rejected), {} on the clock; strain at most {:.3g} %, {}{}{}\n"
             "{}: what it holds: taut info {}; a picture: scripts/render {}\n",
             input.name, simulation.state().time, totals.steps, simulation.rejected_steps(),
             in_words(totals.seconds), 100 * totals.strain_max, limit,
             input.has_contact() ? "; no intersections found" : "", moves ? "; it has not come to rest" : "",
             input.name, out.string(), out.string());
}

void report_failure(MPI_Comm comm, const Outcome& outcome, const fs::path& run) {
  if (rank_of(comm) != 0 || outcome.completed()) return;
  fmt::print(stderr, "taut: {}\n", outcome.reason);
  if (outcome.ending == Ending::interrupted)
    fmt::print(stderr, "taut: nothing is lost; go on with: taut resume {}\n", run.string());
}

} // namespace

std::string case_as_run(Case input) {
  std::vector<std::optional<fs::path>*> paths;
  for (config::Cloth& c : input.cloths)
    paths.insert(paths.end(), {&c.mesh, &c.pattern, &c.start.shape, &c.start.run});
  for (config::Obstacle& o : input.obstacles) paths.insert(paths.end(), {&o.mesh, &o.fitted});
  for (auto* path : paths)
    if (*path) *path = fs::absolute(input.folder() / **path).lexically_normal();
  return write_case(input);
}

namespace {

/// To the end, and then the exit code; or to where the cloth is to be cut anew, with a checkpoint there.
std::optional<int> run_part(MPI_Comm comm, const Case& input, Simulation& simulation,
                            const RunContext& context) {
  const fs::path& out = context.out;
  const State& state = simulation.state();
  const StepSize& steps = simulation.step_size();
  Written written;
  FrameWriter frames(simulation.cloth(), simulation.obstacles(), steps, input, out, written);
  StepLog log(comm, out / run_files::steps, energy_names(simulation.forces()), input.pins.size(), state.step);
  Progress progress(comm, context.progress, steps.frames(), input.time.end);
  IntersectionCheck intersections(simulation.cloth(), simulation.obstacles(), input);
  Summary summary(simulation, input, intersections, context.totals, context.began);
  ContactBalance balance(simulation.cloth().mesh.vertices.total, context.balance);
  Checkpointer checkpoints(simulation, summary, balance, input.checkpoint, out, context.case_text, written);
  std::vector<Observer*> observers{&frames, &log, &progress, &summary, &balance};
  if (input.has_contact()) observers.push_back(&intersections);
  observers.push_back(&checkpoints); // last: what it writes is what all others have seen
  const bool depends_on_places = input.partition.method != config::PartitionMethod::stripes;
  bool is_stopped = false;
  const auto stops = [&] {
    is_stopped = context.stop.received(comm);
    return is_stopped || (depends_on_places && balance.wants_another_cut());
  };
  Outcome outcome = simulation.run(observers, stops, [&] { return has_arrived(input, simulation); });
  if (outcome.completed() && input.sewing) outcome = judge_seams(input, simulation);

  frames.flush();
  checkpoints.write();
  if (outcome.ending == Ending::interrupted && !is_stopped) return std::nullopt;
  if (const Global found = summary.totals(0).intersections; outcome.completed() && found > 0)
    outcome = {
        Ending::failed,
        fmt::format("{} intersections were found in the result; the first: {}; those found then are in {}",
                    found, intersections.first(), (out / run_files::findings).string())};
  if (intersections.count() > 0) write_text_whole(comm, out / run_files::findings, intersections.findings());
  write_text_whole(comm, out / run_files::summary, summary.text(outcome, frames.frames(), written.seconds));
  if (!context.counters.empty())
    write_text_whole(comm, context.counters,
                     counters_text(comm, summary.totals(0), simulation.rejected_steps()));
  if (outcome.completed()) report_success(comm, input, simulation, summary.totals(written.seconds), out);
  report_failure(comm, outcome, context.whole.empty() ? out : context.whole);
  return exit_code(outcome.ending);
}

/// By what is near each other now: the run goes on from its last checkpoint.
void cut_anew(MPI_Comm comm, const Case& input, std::unique_ptr<Simulation>& simulation, RunContext& part) {
  part.began = MPI_Wtime();
  const fs::path file = checkpoint_file(part.out, simulation->state().step);
  simulation.reset();
  simulation = std::make_unique<Simulation>(comm, input, cut_by_checkpoint(file));
  const DistributedMesh& mesh = simulation->cloth().mesh;
  Checkpoint checkpoint = read_checkpoint(file, mesh);
  simulation->restore(std::move(checkpoint.state), checkpoint.step_size, checkpoint.rejected_steps);
  part.totals = std::move(checkpoint.totals);
  part.balance = {};
  if (rank_of(comm) == 0)
    fmt::print("t {:.3f} s: cut anew by what is near each other now ({} edges cut, imbalance {:.3f})\n",
               simulation->state().time, mesh.report.edge_cut, mesh.report.imbalance);
}

} // namespace

int simulate(MPI_Comm comm, const Case& input, std::unique_ptr<Simulation>& simulation,
             const RunContext& context) {
  RunContext part = context;
  if (part.case_text.empty()) part.case_text = case_as_run(input);
  write_text_whole(comm, part.out / run_files::case_as_run, part.case_text);
  tell_of_bodies(comm, input, simulation->obstacles());
  for (;;) {
    if (const auto code = run_part(comm, input, *simulation, part)) return *code;
    cut_anew(comm, input, simulation, part);
  }
}

void announce(MPI_Comm comm, const Simulation& simulation, const Case& input, const fs::path& out) {
  const DistributedMesh& mesh = simulation.cloth().mesh;
  if (rank_of(comm) != 0) return;
  std::vector<std::string> files;
  for (const char* file : files_of(input.output.formats)) files.push_back((out / file).string());
  fmt::print("{}: {} vertices, {} constrained edges, {} pinned, {} frames, by {}, on {} ranks ({} edges "
             "cut, imbalance {:.3f})\n"
             "writing {}\n",
             input.name, mesh.vertices.total, mesh.edges.total, simulation.pins().count(),
             simulation.step_size().frames(), config::word_of(input.inextensibility.method), size_of(comm),
             mesh.report.edge_cut, mesh.report.imbalance, fmt::join(files, ", "));
  std::fflush(stdout);
}

} // namespace taut::command
