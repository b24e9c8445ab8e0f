#pragma once
#include "src/output/checkpoint.hpp"
#include "src/output/summary.hpp"
#include "src/output/written.hpp"

namespace taut {

/// Writes the checkpoints of a run when the case says so; keeps the last two.
class Checkpointer : public Observer {
public:
  /// All references must outlive it, and see a step before. `case_text` is the case as run. What it writes is
  /// added to `written`; the files there will outlive the machine before a checkpoint appears.
  Checkpointer(const Simulation& simulation, const Summary& summary, const ContactBalance& balance,
               config::Checkpoint when, std::filesystem::path run_folder, std::string case_text,
               Written& written);

  void at_start(const State& state) override;
  void between_steps(const State& state) override;

  /// Of the present state, between two steps, unless there is one. Collective.
  void write();

private:
  bool is_due(const State& state) const;
  void make_files_lasting();
  void keep_last_two() const;

  const Simulation& simulation_;
  const Summary& summary_;
  const ContactBalance& balance_;
  config::Checkpoint when_;
  std::filesystem::path folder_;
  std::string case_text_;
  Written& written_;
  double last_time_ = 0;    ///< s, simulated, of the last checkpoint or the start
  double last_clock_ = 0;   ///< MPI_Wtime() then
  double last_seconds_ = 0; ///< that it took
  Global last_step_ = -1;   ///< of the last checkpoint of this program
};

} // namespace taut
