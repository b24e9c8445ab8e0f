#include "src/output/checkpointer.hpp"

#include "io/whole_file.hpp"
#include "partition/traffic.hpp"
#include "src/output/run_files.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace taut {

namespace {

constexpr double often = 60, cheap = 50; // s on the clock; times what the last one took

/// How often `interval` has passed by `time`; a step that ends on a multiple up to round-off has reached it.
double intervals(double time, double interval) { return std::floor(time / interval * (1 + 1e-9)); }

} // namespace

Checkpointer::Checkpointer(const Simulation& simulation, const Summary& summary,
                           const ContactBalance& balance, config::Checkpoint when,
                           std::filesystem::path run_folder, std::string case_text, Written& written)
    : simulation_(simulation), summary_(summary), balance_(balance), when_(when),
      folder_(std::move(run_folder)), case_text_(std::move(case_text)), written_(written) {}

void Checkpointer::at_start(const State& state) {
  last_time_ = state.time;
  last_clock_ = MPI_Wtime();
}

void Checkpointer::between_steps(const State& state) {
  if (is_due(state)) write();
}

/// The same on every rank, though their clocks may differ.
bool Checkpointer::is_due(const State& state) const {
  if (when_.every_steps > 0 && state.step % when_.every_steps == 0) return true;
  if (when_.every_time > 0 &&
      intervals(state.time, when_.every_time) > intervals(last_time_, when_.every_time))
    return true;
  const double interval = when_.every_wall.value_or(std::max(cheap * last_seconds_, often));
  return interval > 0 && any_of(simulation_.cloth().mesh.comm, MPI_Wtime() - last_clock_ >= interval);
}

void Checkpointer::write() {
  const State& state = simulation_.state();
  if (last_step_ == state.step) return;
  const PhaseScope phase(Phase::output);
  const double begin = MPI_Wtime();
  const StepSize::Memory steps = simulation_.step_size().memory();
  const Totals totals = summary_.totals(written_.seconds);
  make_files_lasting();
  write_checkpoint(checkpoint_file(folder_, state.step), simulation_.cloth().mesh,
                   {case_text_, state, steps, simulation_.rejected_steps(), totals, balance_.memory()});
  keep_last_two();
  last_step_ = state.step;
  last_time_ = state.time;
  last_clock_ = MPI_Wtime();
  last_seconds_ = last_clock_ - begin;
  written_.seconds += last_seconds_;
}

/// What a run that goes on from this checkpoint does not write again.
void Checkpointer::make_files_lasting() {
  const auto frames = std::exchange(written_.files, {});
  std::vector<std::filesystem::path> files(frames.begin(), frames.end());
  files.push_back(folder_ / run_files::steps);
  make_lasting(simulation_.cloth().mesh.comm, files);
}

void Checkpointer::keep_last_two() const {
  if (rank_of(simulation_.cloth().mesh.comm) != 0) return;
  const auto files = checkpoints_in(folder_);
  std::error_code ignored; // one too many does no harm
  for (std::size_t k = 2; k < files.size(); ++k) std::filesystem::remove(files[k], ignored);
}

} // namespace taut
