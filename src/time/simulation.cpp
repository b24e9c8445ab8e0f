#include "src/time/simulation.hpp"

#include "partition/traffic.hpp"
#include "src/config/methods.hpp"
#include "src/contact/body_growth.hpp"
#include "src/time/make_forces.hpp"
#include "src/time/make_stepper.hpp"
#include "src/time/where_strained.hpp"

#include <fmt/format.h>

#include <time.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace taut {

namespace {

/// Of this process since its start.
double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}

Vec3 down_of(const Vec3& gravity) {
  return gravity.isZero(0) ? Vec3(-Vec3::UnitZ()) : Vec3(gravity.normalized());
}

} // namespace

Simulation::Simulation(MPI_Comm comm, const Case& input, const Cut& cut)
    : down_(down_of(input.gravity.at(0))), cloth_(load_cloth(comm, input, cut)), obstacles_(comm, input),
      resolved_(resolve(input, cloth_)), state_(start_state(cloth_, input)),
      acceptance_(cloth_, resolved_, input.time.max_stretch_change), pins_(cloth_, input, state_.positions),
      pattern_(cloth_.mesh),
      forces_(make_forces(cloth_, obstacles_, pattern_, input, resolved_, state_.positions)),
      stepper_(
          make_stepper({cloth_, obstacles_, pattern_, pins_, resolved_, state_.positions, forces_}, input)),
      step_size_(input.time) {
  state_.start_depth = lowest(cloth_, state_.positions, down_);
  grow_bodies();
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
  obstacles_.set_growth(state_.bodies, state_.time);
  step_size_.recall(steps);
  rejected_steps_ = rejected_steps;
}

void Simulation::set_start(State state) {
  state_ = std::move(state);
  state_.start_depth = lowest(cloth_, state_.positions, down_);
}

Outcome Simulation::run(std::span<Observer* const> observers, const std::function<bool()>& stop,
                        const std::function<bool()>& finished) {
  const PhaseScope phase(Phase::other);
  for (Observer* o : observers) o->at_start(state_);
  int rejected = 0;  // attempts since the last accepted step
  StepCounts wasted; // on them
  for (Global frame = step_size_.frame_after(state_.time); frame <= step_size_.frames();) {
    if (rejected == 0 && stop())
      return {Ending::interrupted, fmt::format("stopped by a signal at t = {:.6g} s", state_.time)};
    const auto [dt, ends_frame] = step_size_.choose(state_.time, frame);
    const auto [report, strain] = attempt(dt);
    if (!report.failure.empty()) {
      ++rejected_steps_;
      ++rejected;
      wasted.add_seconds_of(report);
      step_size_.rejected(dt);
      if (!step_size_.exhausted()) continue;
      return {Ending::failed, fmt::format("at t = {:.6g} s no step down to {:.3g} s could be accepted: {}{}",
                                          state_.time, dt, report.failure, place_of_fault(strain, dt))};
    }
    step_size_.accepted();
    if (report.too_costly) step_size_.too_costly(dt);
    accept(ends_frame ? step_size_.frame_time(frame) : state_.time + dt, dt);
    StepRecord record;
    record.dt = dt;
    record.rejected = std::exchange(rejected, 0);
    record.counts = report;
    record.residual = report.residual;
    record.strain = strain;
    record.counts.add_seconds_of(std::exchange(wasted, {}));
    measure(record);
    for (Observer* o : observers) o->after_step(state_, record);
    if (ends_frame) {
      for (Observer* o : observers) o->after_frame(state_, frame);
      ++frame;
    }
    for (Observer* o : observers) o->between_steps(state_);
    if (ends_frame && finished()) break;
  }
  return {};
}

double Simulation::strain_over_limit() const {
  if (!resolved_.strain_limit) return 0;
  const double of_gauge = acceptance_.gauge().measure(state_.positions).max / *resolved_.strain_limit;
  if (!resolved_.faces_limit) return of_gauge;
  return std::max(of_gauge, acceptance_.face_strain(state_.positions) / *resolved_.faces_limit);
}

double Simulation::most_strain_of_start() const {
  constexpr double given = 0.5, garment = 1.5;
  const auto is_garment = [](const Piece& piece) { return !piece.parts.panels.empty(); };
  return std::any_of(cloth_.pieces.begin(), cloth_.pieces.end(), is_garment) ? garment : given;
}

/// A projection does what it can even where it fails; nothing intersects then either. What strains the cloth
/// more is tried again with a shorter step, in which contact and forces push less.
Relaxed Simulation::relax() {
  constexpr int most_attempts = 50;
  constexpr double shorter = 0.25;
  Relaxed result;
  result.strain_before = result.strain = strain_over_limit();
  double dt = step_size_.choose(state_.time, step_size_.frame_after(state_.time)).dt;
  State state = state_;
  for (int attempts = 0; attempts < most_attempts && result.strain > 1 &&
                         result.strain * *resolved_.strain_limit <= most_strain_of_start();
       ++attempts) {
    attempt(dt);
    state.positions = candidate_.positions;
    const State before = std::exchange(state_, state);
    const double strain = strain_over_limit();
    if (strain < result.strain) {
      result.strain = strain;
      ++result.steps;
    } else { // or not a number
      state_ = before;
      dt *= shorter;
    }
  }
  state_.start_depth = lowest(cloth_, state_.positions, down_);
  return result;
}

StepReport Simulation::trial_step() {
  return attempt(step_size_.choose(state_.time, step_size_.frame_after(state_.time)).dt).report;
}

/// Proposes the state after `dt` in `candidate_`; the present state stays as it is.
Simulation::Attempt Simulation::attempt(double dt) {
  const double began = MPI_Wtime(), cpu = cpu_seconds();
  candidate_.reset_for(state_);
  Attempt attempt{stepper_->propose(state_, dt, candidate_), {}};
  StepReport& report = attempt.report;
  attempt.strain = acceptance_.gauge().measure(candidate_.positions);
  report.projection_seconds = MPI_Wtime() - began - report.velocity_seconds - report.contact_seconds;
  report.cpu_seconds = cpu_seconds() - cpu;
  if (report.failure.empty()) report.failure = acceptance_.fault_of(state_, candidate_, attempt.strain);
  return attempt;
}

/// Where the strain of a rejected step is beyond the limit, in words.
std::string Simulation::place_of_fault(const Strain& strain, double dt) const {
  if (!acceptance_.is_beyond_limit(strain)) return "";
  const std::string where =
      where_strained(cloth_, acceptance_.gauge(), obstacles_, candidate_.positions, state_.time + dt);
  return where.empty() ? "" : "; " + where;
}

void Simulation::accept(double time, double dt) {
  stepper_->store_history(state_, dt);
  std::swap(state_.positions, candidate_.positions);
  std::swap(state_.velocities,
            candidate_.end_velocities.empty() ? candidate_.velocities : candidate_.end_velocities);
  std::swap(state_.multipliers, candidate_.multipliers);
  std::swap(state_.reported, candidate_.reported);
  state_.time = time;
  ++state_.step;
  grow_bodies();
}

void Simulation::grow_bodies() {
  if (!obstacles_.grow()) return;
  state_.bodies = growth_after(cloth_, obstacles_, state_);
  obstacles_.set_growth(state_.bodies, state_.time);
}

void Simulation::measure(StepRecord& record) const {
  const std::vector<Vec3> pins = pins_.totals(cloth_, state_.reported.reaction);
  const std::vector<std::string> energies = energy_names(forces_);
  std::vector<double> sums(2 + energies.size(), 0.0);
  for (Local i = 0; i < cloth_.mesh.vertices.owned; ++i)
    sums[0] += 0.5 * cloth_.mass[i] * state_.velocities[i].squaredNorm();
  sums[1] = record.counts.cpu_seconds;
  for (const auto& force : forces_)
    sums[2 + (std::find(energies.begin(), energies.end(), force->name()) - energies.begin())] +=
        force->energy(state_);
  for (const Vec3& f : pins) sums.insert(sums.end(), f.begin(), f.end());
  sum_in_place(cloth_.mesh.comm, sums);
  const auto potentials = sums.begin() + 2, forces = potentials + std::ptrdiff_t(energies.size());
  record.energies = {sums[0], {potentials, forces}};
  record.counts.cpu_seconds = sums[1];
  for (auto f = forces; f != sums.end(); f += 3) record.pin_forces.emplace_back(f[0], f[1], f[2]);
  record.face_strain = acceptance_.face_strain(state_.positions);
  record.depth = lowest(cloth_, state_.positions, down_) - state_.start_depth;
}

} // namespace taut
