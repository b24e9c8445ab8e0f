#pragma once
#include "src/time/checkpoint.hpp"
#include "src/time/frame_writer.hpp"
#include "src/time/summary.hpp"

namespace taut {

/// Writes the checkpoints of a run when the case says so; keeps the last two.
class Checkpointer : public Observer {
public:
  /// All references must outlive it. `case_text` is the case as run.
  Checkpointer(const Simulation& simulation, const Summary& summary, FrameWriter& frames,
               config::Checkpoint when, std::filesystem::path run_folder, std::string case_text);

  void at_start(const State& state) override;
  void between_steps(const State& state) override;

  /// Of the present state, between two steps, unless there is one. Collective.
  void write();

  double output_seconds() const { return frames_.seconds() + seconds_; } ///< frames included

private:
  bool is_due(const State& state) const;
  void make_frames_lasting();
  void keep_last_two() const;

  const Simulation& simulation_;
  const Summary& summary_;
  FrameWriter& frames_;
  config::Checkpoint when_;
  std::filesystem::path folder_;
  std::string case_text_;
  double last_time_ = 0;  ///< s, simulated, of the last checkpoint or the start
  double last_clock_ = 0; ///< MPI_Wtime() then
  Global written_ = -1;   ///< step of the last checkpoint of this program
  double seconds_ = 0;
};

} // namespace taut
