#pragma once
#include "src/config/case.hpp"

namespace taut {

/// Chooses time steps: no larger than `time.max_step`, equal within a frame, ending exactly on frames; halved
/// after a rejected step, doubled again after a few accepted ones [BW98 section 6: after a doubling that
/// failed, wait longer before the next].
class StepSize {
public:
  explicit StepSize(const config::Time& time) : time_(time), step_(time.max_step) {}

  Global frames() const; ///< of the whole run, the start not counted
  double frame_time(Global frame) const;

  struct Choice {
    double dt;       ///< s
    bool ends_frame; ///< the step reaches the end of the frame, exactly
  };
  /// The step from `now` within frame `frame` (that is, towards `frame_time(frame)`).
  Choice choose(double now, Global frame) const;

  void accepted();
  void rejected(double dt);
  bool exhausted() const { return step_ < time_.min_step; }

private:
  config::Time time_;
  double step_;
  int successes_ = 0;
  int patience_ = 4;
  bool grew_ = false;
};

} // namespace taut
