#include "src/time/step_size.hpp"

#include <algorithm>
#include <cmath>

namespace taut {

namespace {
constexpr double round_off = 1e-9; ///< relative; a step this much too long is not worth another step
constexpr int longest_patience = 40;
} // namespace

Global StepSize::frames() const {
  return std::max<Global>(1, Global(std::ceil(time_.end * time_.frame_rate * (1 - round_off))));
}

double StepSize::frame_time(Global frame) const {
  return std::min(double(frame) / time_.frame_rate, time_.end);
}

StepSize::Choice StepSize::choose(double now, Global frame) const {
  const double left = frame_time(frame) - now;
  const double steps = std::max(1.0, std::ceil(left / step_ * (1 - round_off)));
  return {left / steps, steps == 1.0};
}

void StepSize::accepted() {
  grew_ = false;
  if (step_ >= time_.max_step || ++successes_ < patience_) return;
  step_ = std::min(2 * step_, time_.max_step);
  successes_ = 0;
  grew_ = true;
}

void StepSize::rejected(double dt) {
  if (grew_) patience_ = std::min(2 * patience_, longest_patience);
  grew_ = false;
  successes_ = 0;
  step_ = dt / 2;
}

} // namespace taut
