#include "src/time/integrator.hpp"

#include <numbers>

namespace taut {

namespace {

constexpr double longest_ratio = 1 + std::numbers::sqrt2;

void extrapolate(const std::vector<Vec3>& present, const std::vector<Vec3>& previous, double ratio,
                 std::vector<Vec3>& result) {
  const double past = ratio * ratio / (1 + 2 * ratio);
  result.resize(present.size());
  for (std::size_t i = 0; i < present.size(); ++i)
    result[i] = present[i] + past * (present[i] - previous[i]); // the weights 1 + past and -past
}

} // namespace

StepStart Integrator::start(const State& state, double dt) {
  const bool has_past = kind_ == config::Integrator::bdf2 && state.previous_dt > 0;
  const double ratio = has_past ? dt / state.previous_dt : 0.0;
  if (!has_past || ratio > longest_ratio) return {state, dt};
  const double euler_dt = (1 + ratio) / (1 + 2 * ratio) * dt;
  extrapolate(state.positions, state.previous_positions, ratio, extrapolated_.positions);
  extrapolate(state.velocities, state.previous_velocities, ratio, extrapolated_.velocities);
  extrapolated_.force_density = state.force_density;
  extrapolated_.time = state.time + dt - euler_dt;
  extrapolated_.step = state.step;
  return {extrapolated_, euler_dt};
}

void Integrator::remember(State& state, double dt) const {
  if (kind_ != config::Integrator::bdf2) return;
  state.previous_positions = state.positions;
  state.previous_velocities = state.velocities;
  state.previous_dt = dt;
}

} // namespace taut
