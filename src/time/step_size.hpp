#pragma once
#include "src/config/case.hpp"

namespace taut {

/// Chooses time steps: no larger than `time.max_step`, equal within a frame, ending exactly on frames. A step
/// that is rejected is tried again shorter by a quarter of the new length; one that is rejected again, by
/// more and more, up to half. After a few accepted ones they grow as slowly, so that they come to stay near
/// the longest that goes well, not anywhere between that and its half [BW98 section 6: after a growth that
/// failed, wait longer before the next]. The last frame is at the end of the run: a
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
  void too_costly(double dt); ///< after `accepted`: shorter ones would be cheaper
  bool exhausted() const { return memory_.step < time_.min_step; }

  /// What it has learnt from the steps so far.
  struct Memory {
    double step = 0;   ///< s, the longest to try
    int successes = 0; ///< accepted steps since `step` changed
    int patience = 2;  ///< accepted steps before it grows
    int failures = 0;  ///< rejected steps since the last accepted one
    bool grew = false; ///< the last step was accepted and made it grow
  };
  const Memory& memory() const { return memory_; }
  void recall(const Memory& memory); ///< goes on from there, within the present `time.max_step`

private:
  config::Time time_;
  Memory memory_;
};

} // namespace taut
