#include "src/output/progress.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace taut {

Progress::Progress(MPI_Comm comm, ProgressStyle style, Global frames, double end_time)
    : speaks_(rank_of(comm) == 0), style_(style), frames_(frames), end_time_(end_time), began_(MPI_Wtime()),
      frame_began_(began_) {}

void Progress::after_step(const State& state, const StepRecord& r) {
  ++frame_.steps;
  frame_.rejected += r.rejected;
  frame_.counts += r.counts;
  frame_.strain = std::max(frame_.strain, r.strain.max);
  if (speaks_ && style_ == ProgressStyle::bar) draw_bar(state);
}

void Progress::after_frame(const State& state, Global frame) {
  if (!speaks_) return;
  const double now = MPI_Wtime(), steps = frame_.steps;
  if (style_ == ProgressStyle::bar) fmt::print("\r\033[K");
  fmt::print("frame {:>{}}/{}  t {:.3f} s  steps {}{}  strain {:.2f} %  projections {:.1f}/step ({:.0f} CG)  "
             "velocity "
             "{:.0f} CG  {} s/frame  left {}\n",
             frame, std::to_string(frames_).size(), frames_, state.time, frame_.steps,
             frame_.rejected > 0 ? fmt::format(" (+{} rejected)", frame_.rejected) : "", 100 * frame_.strain,
             double(frame_.counts.iterations) / steps, double(frame_.counts.linear_iterations) / steps,
             double(frame_.counts.velocity_iterations) / steps, two_digits(now - frame_began_),
             in_words(seconds_left(state)));
  std::fflush(stdout);
  frame_ = {};
  frame_began_ = now;
}

void Progress::draw_bar(const State& state) const {
  constexpr int width = 40;
  const int full = int(width * state.time / end_time_);
  fmt::print("\r\033[K[{:#<{}}{:.<{}}] {:3.0f} %  t {:.4f} s  left {}", "", full, "", width - full,
             100 * state.time / end_time_, state.time, in_words(seconds_left(state)));
  std::fflush(stdout);
}

double Progress::seconds_left(const State& state) const {
  return (MPI_Wtime() - began_) * (end_time_ - state.time) / (state.time - start_time_);
}

std::string two_digits(double number) {
  return number < 100 ? fmt::format("{:.2g}", number) : fmt::format("{:.0f}", number);
}

std::string in_words(double seconds) {
  const Global s = std::llround(seconds);
  if (s < 60) return fmt::format("{} s", s);
  if (s < 3600) return fmt::format("{} min {:02} s", s / 60, s % 60);
  return fmt::format("{} h {:02} min", s / 3600, s % 3600 / 60);
}

} // namespace taut
