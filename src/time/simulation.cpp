#include "src/time/simulation.hpp"

#include "partition/traffic.hpp"
#include "src/config/methods.hpp"
#include "src/constraints/edge_set.hpp"
#include "src/filters/contact_projection.hpp"
#include "src/filters/impulse_contact.hpp"
#include "src/filters/make_filter.hpp"
#include "src/state/start.hpp"
#include "src/time/make_forces.hpp"
#include "src/time/where_strained.hpp"

#include <fmt/format.h>

#include <time.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace taut {

namespace {

std::unique_ptr<VelocityFilter> make_contact_projection(const Cloth& cloth, const Obstacles& obstacles,
                                                        const Case& input, const Resolved& resolved) {
  return std::make_unique<ContactProjection<EdgeSet>>(
      cloth, obstacles, Thickness(cloth, input),
      ContactProjectionOptions{.limits = resolved.inextensibility,
                               .contact = input.contact.value_or(config::Contact{}),
                               .gravity = input.gravity.norm(),
                               .longest_step = input.time.max_step});
}

std::vector<std::unique_ptr<VelocityFilter>> make_filters(const Cloth& cloth, const Obstacles& obstacles,
                                                          const Pattern& pattern, const Case& input,
                                                          const Resolved& resolved) {
  std::vector<std::unique_ptr<VelocityFilter>> filters;
  if (input.contact_model() == config::ContactModel::constraint) {
    filters.push_back(make_contact_projection(cloth, obstacles, input, resolved));
    return filters;
  }
  if (auto filter = make_filter(cloth, pattern, resolved.inextensibility))
    filters.push_back(std::move(filter));
  if (input.contact_model() == config::ContactModel::impulse)
    filters.insert(config::contact_is_last(input) ? filters.end() : filters.begin(),
                   std::make_unique<ImpulseContact>(cloth, obstacles, input));
  return filters;
}

/// Predictions that are made again in a step; what solids still pull then is let go in the next step.
constexpr int most_releases = 1;

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

/// Of this process since its start.
double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}

} // namespace

Simulation::Simulation(MPI_Comm comm, const Case& input)
    : comm_(comm), down_(input.gravity.norm() > 0 ? Vec3(input.gravity.normalized()) : Vec3(-Vec3::UnitZ())),
      cloth_(load_cloth(comm, input)), obstacles_(comm, input), resolved_(resolve(input, cloth_)),
      state_(start_state(cloth_, input)), gauge_(cloth_, *resolved_.inextensibility.constrain),
      pins_(cloth_, input, state_.positions), pattern_(cloth_.mesh),
      forces_(make_forces(cloth_, obstacles_, pattern_, input)),
      filters_(make_filters(cloth_, obstacles_, pattern_, input, resolved_)),
      integrator_(input.time.integrator),
      predictor_(cloth_, pattern_, forces_, input.velocity, input.time.integrator), step_size_(input.time),
      max_stretch_change_(input.time.max_stretch_change), freedom_(state_.positions.size()),
      start_depth_(lowest(cloth_, state_.positions, down_)) {
  if (input.inextensibility.method == config::InextensibilityMethod::xpbd)
    xpbd_.emplace(cloth_, pattern_, forces_, pins_, input.inextensibility);
  if (max_stretch_change_ || limits_averages()) tangents_ = tangents_of(cloth_);
  if (input.contact_model() != config::ContactModel::penalty || obstacles_.empty()) return;
  solids_.emplace(cloth_, obstacles_, input);
  forces_.push_back(std::make_unique<SolidFriction>(*solids_));
}

/// The case may have use for other fields than the one that wrote the state.
void Simulation::restore(State state, const StepSize::Memory& steps, Global rejected_steps) {
  state.reported.reaction.resize(state_.reported.reaction.size(), Vec3::Zero());
  state.multipliers.carried_contact_force.resize(state_.multipliers.carried_contact_force.size(),
                                                 Vec3::Zero());
  state.reported.contact_force.resize(state_.reported.contact_force.size(), Vec3::Zero());
  state.multipliers.stress.resize(state_.multipliers.stress.size(), Vec2::Zero());
  state.multipliers.projection_tension.resize(state_.multipliers.projection_tension.size(), 0.0);
  state_ = std::move(state);
  step_size_.recall(steps);
  rejected_steps_ = rejected_steps;
}

void Simulation::set_start(State state) {
  state_ = std::move(state);
  start_depth_ = lowest(cloth_, state_.positions, down_);
}

Outcome Simulation::run(std::span<Observer* const> observers, const std::function<bool()>& stop) {
  const PhaseScope phase(Phase::other);
  for (Observer* o : observers) o->at_start(state_);
  int rejected = 0;    // attempts since the last accepted step
  PhaseSeconds wasted; // on them
  for (Global frame = step_size_.frame_after(state_.time); frame <= step_size_.frames();) {
    if (rejected == 0 && stop())
      return {Ending::interrupted, fmt::format("stopped by a signal at t = {:.6g} s", state_.time)};
    const auto [dt, ends_frame] = step_size_.choose(state_.time, frame);
    auto [record, failure, too_costly] = attempt(dt);
    if (!failure.empty()) {
      ++rejected_steps_;
      ++rejected;
      wasted += record.seconds;
      step_size_.rejected(dt);
      if (!step_size_.exhausted()) continue;
      return {Ending::failed, fmt::format("at t = {:.6g} s no step down to {:.3g} s could be accepted: {}{}",
                                          state_.time, dt, failure, place_of_fault(record))};
    }
    step_size_.accepted();
    if (too_costly) step_size_.too_costly(dt);
    accept(ends_frame ? step_size_.frame_time(frame) : state_.time + dt, dt);
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

void Simulation::trial_step() {
  attempt(step_size_.choose(state_.time, step_size_.frame_after(state_.time)).dt);
}

/// Proposes the state after `dt` in `candidate_`; the present state stays as it is.
Simulation::Attempt Simulation::attempt(double dt) {
  Attempt attempt;
  StepRecord& record = attempt.record;
  record.dt = dt;
  candidate_.reset_for(state_);
  Stopwatch watch;
  const double cpu = cpu_seconds();
  const StepStart start = start_of_step(dt);
  if (xpbd_) {
    xpbd_->advance(state_, dt, freedom_, candidate_);
    record.iterations = xpbd_->substeps();
  } else {
    predict(start, attempt);
    record.seconds.velocity = watch.lap();
    filter(start, attempt);
  }
  candidate_.positions.resize(state_.positions.size());
  for (std::size_t i = 0; i < candidate_.positions.size(); ++i)
    candidate_.positions[i] = start.state.positions[i] + start.dt * candidate_.velocities[i];
  if (config::is_filter(resolved_.inextensibility.method)) add_pull_of_filters();
  if (solids_) solids_->note_forces(candidate_);
  record.strain = gauge_.measure(candidate_.positions);
  record.seconds.projection = watch.lap() - record.seconds.contact;
  record.seconds.cpu = cpu_seconds() - cpu;
  if (attempt.failure.empty()) attempt.failure = fault_of(record.strain);
  if (attempt.failure.empty()) attempt.failure = fault_of_stretch();
  return attempt;
}

bool Simulation::all_finite(std::span<const Vec3> field) const {
  return !any_of(comm_,
                 std::any_of(field.begin(), field.end(), [](const Vec3& v) { return !v.allFinite(); }));
}

/// Solids alter positions: the step then starts from others than those at which forces are taken.
StepStart Simulation::start_of_step(double dt) {
  if (!solids_) return integrator_.start(state_, dt);
  candidate_.velocities = state_.velocities;
  pins_.prescribe(state_, dt, freedom_, candidate_.velocities);
  solids_->find(state_, dt, freedom_);
  altered_ = state_;
  const auto y = solids_->alteration();
  for (std::size_t i = 0; i < y.size(); ++i) altered_.positions[i] += y[i];
  return {altered_, dt, state_};
}

/// The velocities of the candidate before any filter, and the tensions that filters start from. Where solids
/// would have to pull, it is made again without them.
void Simulation::predict(const StepStart& start, Attempt& attempt) {
  const PhaseScope phase(Phase::velocity);
  for (std::size_t e = 0; e < state_.multipliers.force_density.size(); ++e)
    candidate_.multipliers.force_density[e] = carried(state_.multipliers.force_density[e]);
  for (int round = 0;; ++round) {
    candidate_.velocities = start.state.velocities;
    pins_.prescribe(start.state, start.dt, freedom_, candidate_.velocities);
    if (solids_) solids_->prescribe(freedom_, candidate_.velocities);
    const SolveReport predicted =
        predictor_.predict(start, freedom_, candidate_.velocities, candidate_.reported.reaction);
    attempt.record.velocity_iterations += predicted.iterations;
    if (!predicted.failure.empty()) attempt.failure = "the velocity solver failed: " + predicted.failure;
    if (!solids_ || !attempt.failure.empty()) return;
    if (round == most_releases || !solids_->let_go(candidate_.reported.reaction)) break;
  }
  solids_->loosen(freedom_);
}

void Simulation::filter(const StepStart& start, Attempt& attempt) {
  const PhaseScope phase(Phase::projection);
  for (std::size_t k = 0; k < filters_.size() && attempt.failure.empty(); ++k) {
    const FilterReport filtered = filters_[k]->apply(start.state, start.dt, freedom_, candidate_);
    attempt.too_costly = attempt.too_costly || filtered.too_costly;
    attempt.record.iterations += filtered.iterations;
    attempt.record.linear_iterations += filtered.linear_iterations;
    attempt.record.contacts = std::max(attempt.record.contacts, filtered.contacts);
    attempt.record.contacts_if_even = std::max(attempt.record.contacts_if_even, filtered.contacts_if_even);
    attempt.record.seconds.contact += filtered.contact_seconds;
    // where contact has the last word and breaks the limit, the projection only does what it can
    const bool has_last_word = k + 1 == filters_.size();
    if (resolved_.strain_limit || has_last_word || !all_finite(candidate_.velocities))
      attempt.failure = filtered.failure;
  }
}

/// Prescribed velocities are kept by the prediction, which knows the tension carried into the step, and
/// against what filters add to it: from what prescribing them took, to what it took at the end of the step.
void Simulation::add_pull_of_filters() {
  if (freedom_.all_free()) return;
  for (Local i = 0; i < cloth_.mesh.vertices.owned; ++i) {
    if (freedom_.is_free(i)) continue;
    Vec3 pull = Vec3::Zero();
    for (const EdgeEnd& end : cloth_.mesh.star_of(i))
      pull += (candidate_.multipliers.force_density[end.edge] -
               carried(state_.multipliers.force_density[end.edge])) *
              (candidate_.positions[end.other] - candidate_.positions[i]);
    candidate_.reported.reaction[i] -= freedom_.denied(i, pull);
  }
}

/// What the prediction carries of a force density of the step before.
double Simulation::carried(double force_density) const {
  return resolved_.inextensibility.carried_tension ? std::max(force_density, 0.0) : 0.0;
}

/// Why a step with this strain cannot be accepted; empty if it can.
std::string Simulation::fault_of(const Strain& strain) const {
  if (!std::isfinite(strain.max)) return "positions are no longer numbers";
  if (!resolved_.strain_limit || strain.max <= *resolved_.strain_limit) return "";
  return fmt::format("the measured strain is {:.3g}, over the limit {:g}", strain.max,
                     *resolved_.strain_limit);
}

/// The same for how drastically stretch changes in it [BW98 section 6].
std::string Simulation::fault_of_stretch() const {
  if (!max_stretch_change_) return "";
  const double change = largest_stretch_change(cloth_, tangents_, state_.positions, candidate_.positions);
  if (change <= *max_stretch_change_) return "";
  return fmt::format("the stretch of warp or weft changes by {:.3g}, over time.max_stretch_change, {:g}",
                     change, *max_stretch_change_);
}

/// Where the strain of a rejected step is beyond the limit, in words.
std::string Simulation::place_of_fault(const StepRecord& record) const {
  if (!resolved_.strain_limit || !(record.strain.max > *resolved_.strain_limit)) return "";
  const std::string where =
      where_strained(cloth_, gauge_, obstacles_, candidate_.positions, state_.time + record.dt);
  return where.empty() ? "" : "; " + where;
}

void Simulation::accept(double time, double dt) {
  integrator_.store_history(state_, dt);
  std::swap(state_.positions, candidate_.positions);
  std::swap(state_.velocities,
            candidate_.end_velocities.empty() ? candidate_.velocities : candidate_.end_velocities);
  std::swap(state_.multipliers, candidate_.multipliers);
  std::swap(state_.reported, candidate_.reported);
  state_.time = time;
  ++state_.step;
}

void Simulation::measure(StepRecord& record) const {
  const std::vector<Vec3> pins = pins_.totals(cloth_, state_.reported.reaction);
  const std::vector<std::string> energies = energy_names(forces_);
  std::vector<double> sums(2 + energies.size(), 0.0);
  for (Local i = 0; i < cloth_.mesh.vertices.owned; ++i)
    sums[0] += 0.5 * cloth_.mass[i] * state_.velocities[i].squaredNorm();
  sums[1] = record.seconds.cpu;
  for (const auto& force : forces_)
    sums[2 + (std::find(energies.begin(), energies.end(), force->name()) - energies.begin())] +=
        force->energy(state_);
  for (const Vec3& f : pins) sums.insert(sums.end(), f.begin(), f.end());
  sum_in_place(comm_, sums);
  const auto potentials = sums.begin() + 2, forces = potentials + std::ptrdiff_t(energies.size());
  record.energies = {sums[0], {potentials, forces}};
  record.seconds.cpu = sums[1];
  for (auto f = forces; f != sums.end(); f += 3) record.pin_forces.emplace_back(f[0], f[1], f[2]);
  if (limits_averages()) record.face_strain = largest_strain(cloth_, tangents_, state_.positions);
  record.depth = lowest(cloth_, state_.positions, down_) - start_depth_;
}

} // namespace taut
