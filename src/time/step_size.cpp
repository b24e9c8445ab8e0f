#include "src/time/step_size.hpp"

#include <algorithm>
#include <cmath>

namespace taut {

namespace {
constexpr double round_off = 1e-9; ///< relative; a step this much too long is not worth another step
constexpr double sliver = 0.1;     ///< of the longest step; a frame waits for an end that comes so soon after
constexpr int longest_patience = 40;
constexpr double factor = 1.25; ///< by which steps shrink and grow
constexpr double most = 2;      ///< by which they shrink where one is rejected again and again
} // namespace

Global StepSize::frames() const {
  const double short_of_a_frame = sliver * std::min(time_.max_step * time_.frame_rate, 1.0);
  return std::max<Global>(1, Global(std::ceil(time_.end * time_.frame_rate - short_of_a_frame)));
}

double StepSize::frame_time(Global frame) const {
  return frame < frames() ? double(frame) / time_.frame_rate : time_.end;
}

Global StepSize::frame_after(double time) const {
  auto frame = std::max<Global>(0, Global(std::floor(time * time_.frame_rate)) - 1);
  while (frame <= frames() && frame_time(frame) <= time) ++frame;
  return frame;
}

StepSize::Choice StepSize::choose(double now, Global frame) const {
  const double left = frame_time(frame) - now;
  const double steps = std::max(1.0, std::ceil(left / memory_.step * (1 - round_off)));
  return {left / steps, steps == 1.0};
}

void StepSize::accepted() {
  memory_.grew = false;
  memory_.failures = 0;
  if (memory_.step >= time_.max_step || ++memory_.successes < memory_.patience) return;
  memory_.step = std::min(factor * memory_.step, time_.max_step);
  memory_.successes = 0;
  memory_.grew = true;
}

void StepSize::rejected(double dt) {
  if (memory_.grew) memory_.patience = std::min(2 * memory_.patience, longest_patience);
  memory_.grew = false;
  memory_.successes = 0;
  memory_.step = dt / std::min(std::pow(factor, ++memory_.failures), most);
}

/// What is dear for other reasons than its length must not end in steps of no length.
void StepSize::too_costly(double dt) {
  constexpr double shortest = 1.0 / 16; // of the longest, about
  if (dt <= 1.5 * shortest * time_.max_step) return;
  rejected(dt);
  memory_.failures = 0;
}

void StepSize::recall(const Memory& memory) {
  memory_ = memory;
  memory_.step = std::min(memory_.step, time_.max_step);
}

} // namespace taut
