#include "src/time/simulation.hpp"

#include "src/filters/contact_projection.hpp"
#include "src/filters/fast_projection.hpp"
#include "src/state/start.hpp"
#include "src/time/make_forces.hpp"

#include <fmt/format.h>

#include <utility>

namespace taut {

namespace {

std::vector<std::unique_ptr<VelocityFilter>> make_filters(const Cloth& cloth, const Case& input) {
  std::vector<std::unique_ptr<VelocityFilter>> filters;
  double mass = 0;
  for (Local i = 0; i < cloth.mesh.vertices.owned; ++i) mass += cloth.mass[i];
  const double weight = sum_over(cloth.mesh.comm, mass) * input.gravity.norm();
  if (input.has_contact())
    filters.push_back(std::make_unique<ContactProjection>(cloth, input, weight));
  else if (input.inextensibility.method == config::InextensibilityMethod::fast_projection)
    filters.push_back(std::make_unique<FastProjection>(cloth, input.inextensibility, weight));
  return filters;
}

/// Seconds since the last call.
class Stopwatch {
public:
  double lap() {
    const double now = MPI_Wtime(), lap = now - last_;
    last_ = now;
    return lap;
  }

private:
  double last_ = MPI_Wtime();
};

} // namespace

Simulation::Simulation(MPI_Comm comm, const Case& input)
    : comm_(comm), inextensibility_(input.inextensibility),
      down_(input.gravity.norm() > 0 ? Vec3(input.gravity.normalized()) : Vec3(-Vec3::UnitZ())),
      cloth_(load_cloth(comm, input)), state_(start_state(cloth_, input)),
      pins_(cloth_, input, state_.positions), pattern_(cloth_.mesh),
      forces_(make_forces(cloth_, pattern_, input)), filters_(make_filters(cloth_, input)),
      integrator_(cloth_, pattern_, forces_, input.velocity), step_size_(input.time),
      end_positions_(state_.positions.size()), freedom_(state_.positions.size()),
      start_depth_(lowest(cloth_, state_.positions, down_)) {}

void Simulation::go_on_from(State state, const StepSize::Memory& steps, Global rejected_steps) {
  state_ = std::move(state);
  step_size_.recall(steps);
  rejected_steps_ = rejected_steps;
}

Outcome Simulation::run(std::span<Observer* const> observers, const std::function<bool()>& stop) {
  for (Observer* o : observers) o->at_start(state_);
  int rejected = 0;    // attempts since the last accepted step
  PhaseSeconds wasted; // on them
  for (Global frame = step_size_.frame_after(state_.time); frame <= step_size_.frames();) {
    if (rejected == 0 && stop())
      return {Ending::interrupted, fmt::format("stopped by a signal at t = {:.6g} s", state_.time)};
    const auto [dt, ends_frame] = step_size_.choose(state_.time, frame);
    auto [record, failure] = attempt(dt);
    if (!failure.empty()) {
      ++rejected_steps_;
      ++rejected;
      wasted += record.seconds;
      step_size_.rejected(dt);
      if (!step_size_.exhausted()) continue;
      return {Ending::failed, fmt::format("at t = {:.6g} s no step down to {:.3g} s could be accepted: {}",
                                          state_.time, dt, failure)};
    }
    step_size_.accepted();
    accept(ends_frame ? step_size_.frame_time(frame) : state_.time + dt);
    record.rejected = std::exchange(rejected, 0);
    record.seconds += std::exchange(wasted, {});
    measure(record);
    for (Observer* o : observers) o->after_step(state_, record);
    if (ends_frame) {
      for (Observer* o : observers) o->after_frame(state_, frame);
      ++frame;
    }
    for (Observer* o : observers) o->between_steps(state_);
  }
  return {};
}

void Simulation::rehearse() {
  attempt(step_size_.choose(state_.time, step_size_.frame_after(state_.time)).dt);
}

/// Proposes the state after `dt` in `candidate_` and `end_positions_`; the present state stays as it is.
Simulation::Attempt Simulation::attempt(double dt) {
  Attempt attempt;
  StepRecord& record = attempt.record;
  record.dt = dt;
  Stopwatch watch;
  candidate_.velocities = state_.velocities;
  candidate_.force_density.resize(state_.force_density.size());
  for (std::size_t e = 0; e < state_.force_density.size(); ++e)
    candidate_.force_density[e] = carried(state_.force_density[e]);
  pins_.prescribe(state_, dt, freedom_, candidate_.velocities);
  const SolveReport predicted =
      integrator_.predict(state_, dt, freedom_, candidate_.velocities, candidate_.reaction);
  record.velocity_iterations = predicted.iterations;
  record.seconds.velocity = watch.lap();
  if (!predicted.failure.empty()) attempt.failure = "the velocity solver failed: " + predicted.failure;

  for (std::size_t k = 0; k < filters_.size() && attempt.failure.empty(); ++k) {
    const FilterReport filtered = filters_[k]->apply(state_, dt, freedom_, candidate_);
    record.iterations += filtered.iterations;
    record.linear_iterations += filtered.linear_iterations;
    record.contacts = std::max(record.contacts, filtered.contacts);
    record.seconds.contact += filtered.contact_seconds;
    attempt.failure = filtered.failure;
  }
  for (std::size_t i = 0; i < end_positions_.size(); ++i)
    end_positions_[i] = state_.positions[i] + dt * candidate_.velocities[i];
  add_pull_of_filters();
  record.strain = measure_strain(cloth_, end_positions_);
  record.seconds.projection = watch.lap() - record.seconds.contact;

  const bool limited = inextensibility_.method != config::InextensibilityMethod::none;
  if (attempt.failure.empty() && limited && !(record.strain.max <= inextensibility_.strain))
    attempt.failure = fmt::format("the measured strain is {:.3g}, over the limit {:g}", record.strain.max,
                                  inextensibility_.strain);
  return attempt;
}

/// Prescribed velocities are kept by the prediction, which knows the tension carried into the step, and
/// against what filters add to it.
void Simulation::add_pull_of_filters() {
  pull_.resize(state_.force_density.size());
  for (std::size_t e = 0; e < pull_.size(); ++e)
    pull_[e] = candidate_.force_density[e] - carried(state_.force_density[e]);
  pins_.add_pull(cloth_, freedom_, end_positions_, pull_, candidate_.reaction);
}

/// What the prediction carries of a force density of the step before.
double Simulation::carried(double force_density) const {
  return inextensibility_.carried_tension ? std::max(force_density, 0.0) : 0.0;
}

void Simulation::accept(double time) {
  std::swap(state_.positions, end_positions_);
  std::swap(state_.velocities, candidate_.velocities);
  std::swap(state_.force_density, candidate_.force_density);
  std::swap(state_.reaction, candidate_.reaction);
  state_.time = time;
  ++state_.step;
}

void Simulation::measure(StepRecord& record) const {
  const std::vector<Vec3> pins = pins_.totals(cloth_, state_.reaction);
  std::vector<double> sums(1 + forces_.size(), 0.0);
  for (Local i = 0; i < cloth_.mesh.vertices.owned; ++i)
    sums[0] += 0.5 * cloth_.mass[i] * state_.velocities[i].squaredNorm();
  for (std::size_t k = 0; k < forces_.size(); ++k) sums[1 + k] = forces_[k]->energy(state_);
  for (const Vec3& f : pins) sums.insert(sums.end(), f.begin(), f.end());
  sum_in_place(comm_, sums);
  const auto potentials = sums.begin() + 1, forces = potentials + std::ptrdiff_t(forces_.size());
  record.energies = {sums[0], {potentials, forces}};
  for (auto f = forces; f != sums.end(); f += 3) record.pin_forces.emplace_back(f[0], f[1], f[2]);
  record.depth = lowest(cloth_, state_.positions, down_) - start_depth_;
}

} // namespace taut
