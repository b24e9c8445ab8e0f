#pragma once
#include "src/config/case.hpp"

namespace taut {

/// Chooses time steps: no larger than `time.max_step`, equal within a frame, ending exactly on frames; halved
/// after a rejected step or one that too_costly, doubled again after a few accepted ones [BW98 section 6:
/// after a doubling that failed, wait longer before the next]. The last frame is at the end of the run: a
/// step that is tiny beside the others would shake the cloth, because it corrects in no time what strain the
/// one before left.
class StepSize {
public:
  explicit StepSize(const config::Time& time) : time_(time), memory_{.step = time.max_step} {}

  Global frames() const; ///< of the whole run, the start not counted
  double frame_time(Global frame) const;
  Global frame_after(double time) const; ///< the first that ends later than `time`

  struct Choice {
    double dt;       ///< s
    bool ends_frame; ///< the step reaches the end of the frame, exactly
  };
  /// The step from `now` within frame `frame` (that is, towards `frame_time(frame)`).
  Choice choose(double now, Global frame) const;

  void accepted();
  void rejected(double dt);
  void too_costly(double dt); ///< after `accepted`: half the length would be cheaper
  bool exhausted() const { return memory_.step < time_.min_step; }

  /// What it has learnt from the steps so far.
  struct Memory {
    double step = 0;   ///< s, the longest to try
    int successes = 0; ///< accepted steps since `step` changed
    int patience = 4;  ///< accepted steps before it doubles
    bool grew = false; ///< the last step was accepted and doubled it
  };
  const Memory& memory() const { return memory_; }
  void recall(const Memory& memory); ///< goes on from there, within the present `time.max_step`

private:
  config::Time time_;
  Memory memory_;
};

} // namespace taut
