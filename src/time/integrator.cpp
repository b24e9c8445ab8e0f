#include "src/time/integrator.hpp"

#include <numbers>

namespace taut {

namespace {

constexpr double longest_ratio = 1 + std::numbers::sqrt2;

void extrapolate(const std::vector<Vec3>& present, const std::vector<Vec3>& previous, double by,
                 std::vector<Vec3>& result) {
  result.resize(present.size());
  for (std::size_t i = 0; i < present.size(); ++i) result[i] = present[i] + by * (present[i] - previous[i]);
}

/// `state` with positions and velocities that go on from the previous ones by so many times the last step.
void extrapolate(const State& state, double by, double time, State& result) {
  result = state;
  extrapolate(state.positions, state.previous_positions, by, result.positions);
  extrapolate(state.velocities, state.previous_velocities, by, result.velocities);
  result.time = time;
}

} // namespace

void set_positions(const StepStart& start, Candidate& candidate) {
  candidate.positions.resize(start.state.positions.size());
  for (std::size_t i = 0; i < candidate.positions.size(); ++i)
    candidate.positions[i] = start.state.positions[i] + start.dt * candidate.velocities[i];
}

StepStart Integrator::start(const State& state, double dt) {
  const bool has_past = kind_ == config::Integrator::bdf2 && state.previous_dt > 0;
  const double ratio = has_past ? dt / state.previous_dt : 0.0;
  if (!has_past || ratio > longest_ratio) return {state, dt, state};
  const double euler_dt = (1 + ratio) / (1 + 2 * ratio) * dt;
  // (1 + r)^2 / (1 + 2r) = 1 + r^2 / (1 + 2r)
  extrapolate(state, ratio * ratio / (1 + 2 * ratio), state.time + dt - euler_dt, bdf_base_);
  extrapolate(state, ratio, state.time + dt, linearization_point_);
  return {bdf_base_, euler_dt, linearization_point_};
}

void Integrator::store_history(State& state, double dt) const {
  if (kind_ != config::Integrator::bdf2) return;
  state.previous_positions = state.positions;
  state.previous_velocities = state.velocities;
  state.previous_dt = dt;
}

} // namespace taut
