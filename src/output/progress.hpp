#pragma once
#include "src/time/observer.hpp"

#include <string>

namespace taut {

enum class ProgressStyle {
  lines, ///< one line a frame
  bar,   ///< one line a frame, and a bar that moves with the steps; for terminals
};

/// Tells how a run goes on, on rank 0's standard output.
class Progress : public Observer {
public:
  Progress(MPI_Comm comm, ProgressStyle style, Global frames, double end_time);

  void at_start(const State& state) override { start_time_ = state.time; }
  void after_step(const State& state, const StepRecord& record) override;
  void after_frame(const State& state, Global frame) override;

private:
  void draw_bar(const State& state) const;
  double seconds_left(const State& state) const;

  bool speaks_;
  ProgressStyle style_;
  Global frames_;
  double end_time_;
  double start_time_ = 0; ///< s, simulated
  double began_, frame_began_;
  struct {
    int steps = 0, rejected = 0;
    StepCounts counts;
    double strain = 0;
  } frame_;
};

/// "0.012", "3.4", "150": as few digits as tell, without exponents of ten above 1
std::string two_digits(double number);

/// "4 s", "2 min 05 s", "3 h 12 min"
std::string in_words(double seconds);

} // namespace taut
