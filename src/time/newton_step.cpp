#include "src/time/newton_step.hpp"

#include "partition/traffic.hpp"
#include "src/constraints/mixed_set.hpp"
#include "src/linear/kkt_system.hpp"

#include <fmt/format.h>

#include <cmath>

namespace taut {

namespace {

constexpr int most_iterations = 100; // of a solve

} // namespace

template<ConstraintSetInNewton Set>
NewtonStep<Set>::NewtonStep(const StepperParts& parts, const Case& input)
    : cloth_(parts.cloth), pins_(parts.pins), options_(parts.resolved.inextensibility),
      gravity_(input.gravity.norm() > 0 ? input.gravity.norm() : 1.0), longest_step_(input.time.max_step),
      integrator_(input.time.integrator),
      assembly_(parts.cloth, parts.pattern, parts.forces, input.time.integrator),
      set_(parts.cloth, options_, ConstraintUse::in_newton), solver_(parts.cloth, parts.pattern, set_),
      stiffness_(parts.cloth.mesh), freedom_(parts.cloth.mesh.vertices.size()),
      slots_(edge_slots(parts.cloth.mesh, parts.pattern)), weights_(parts.cloth.mesh.edges.size()),
      added_(weights_), rows_(set_.rows()), change_(rows_), kept_(rows_),
      residual_(parts.cloth.mesh.vertices.size()), left_(parts.cloth.mesh.vertices.owned), dx_(residual_) {}

template<ConstraintSetInNewton Set>
StepReport NewtonStep<Set>::propose(const State& state, double dt, Candidate& candidate) {
  const StepStart start = integrator_.start(state, dt);
  StepReport report;
  begin(start, candidate);
  iterate(start, candidate, report);
  set_.finish(candidate);
  find_reaction(start.dt, candidate);
  return report;
}

template<ConstraintSetInNewton Set>
void NewtonStep<Set>::begin(const StepStart& start, Candidate& candidate) {
  const PhaseScope phase(Phase::velocity);
  candidate.velocities = start.state.velocities;
  pins_.prescribe(start.state, start.dt, freedom_, candidate.velocities);
  assembly_.assemble(start);
  stiffness_.set(assembly_.system().matrix(), freedom_);
  std::fill(added_.begin(), added_.end(), 0.0);
  if (options_.carried_tension) candidate.multipliers.force_density = start.state.multipliers.force_density;
  set_.start(start.state, start.dt, freedom_, candidate);
  keep_violation(start);
}

/// A step that is short all of a sudden need not correct at once what long ones have left: vertices would be
/// torn to their places in no time.
template<ConstraintSetInNewton Set>
void NewtonStep<Set>::keep_violation(const StepStart& start) {
  const double part = std::max(1 - 4 * start.dt / longest_step_, 0.0);
  std::fill(kept_.begin(), kept_.end(), 0.0);
  if (part == 0) return;
  set_.evaluate(start.state.positions);
  set_.residual(kept_);
  for (double& c : kept_) c *= part;
}

template<ConstraintSetInNewton Set>
void NewtonStep<Set>::iterate(const StepStart& start, Candidate& candidate, StepReport& report) {
  const PhaseScope phase(Phase::projection);
  for (;; ++report.iterations) {
    set_positions(start, candidate);
    const double strain = set_.evaluate(candidate.positions);
    find_residual(start.dt, candidate.velocities);
    set_.residual(rows_);
    for (std::size_t row = 0; row < rows_.size(); ++row) rows_[row] -= kept_[row];
    const double unit = unit_of_movement(start, candidate);
    const double left = report.iterations > 0 ? solver_.movement(left_, rows_) / unit : 0.0;
    if (report.iterations > 0 && strain <= options_.strain && left <= options_.residual) return;
    if (!std::isfinite(strain) || !std::isfinite(left) || report.iterations == options_.max_iterations) {
      report.failure =
          fmt::format("Newton's method left a strain of {:.3g} and a residual of {:.3g} after {} "
                      "solves (limits {:g} and {:g})",
                      strain, left, report.iterations, options_.strain, options_.residual);
      return;
    }
    if (!solve(start.dt, unit, candidate, report)) return;
  }
}

/// How far gravity moves the cloth in the step, or what accelerates it more so far; root mean square, in m.
template<ConstraintSetInNewton Set>
double NewtonStep<Set>::unit_of_movement(const StepStart& start, const Candidate& candidate) {
  for (std::size_t i = 0; i < dx_.size(); ++i)
    dx_[i] = start.dt * (candidate.velocities[i] - start.state.velocities[i]);
  return std::max(gravity_ * start.dt * start.dt, solver_.rms(dx_));
}

/// Whether there is a change to go on from.
template<ConstraintSetInNewton Set>
bool NewtonStep<Set>::solve(double dt, double unit, Candidate& candidate, StepReport& report) {
  constexpr double part = 0.05, part_of_strain = 0.3; // of what the step may leave: what turns comes on top
  stiffen();
  solver_.factor(stiffness_);
  const SolveReport solved = solver_.solve(left_, rows_, {part * options_.residual * unit, part_of_strain},
                                           most_iterations, dx_, change_);
  report.linear_iterations += solved.iterations;
  if (solved.iterations == most_iterations) {
    report.failure = fmt::format("Newton's linear solver did not converge in {} iterations", most_iterations);
    return false;
  }
  for (std::size_t i = 0; i < dx_.size(); ++i) candidate.velocities[i] += dx_[i] / dt;
  set_.add(change_);
  return true;
}

/// h (b - A v) - J^T mu at owned vertices, for the matrix A without tension's part.
template<ConstraintSetInNewton Set>
void NewtonStep<Set>::find_residual(double dt, std::span<const Vec3> v) {
  const DistributedMesh& mesh = cloth_.mesh;
  assembly_.system().matrix().multiply(v, residual_);
  const auto b = assembly_.system().rhs();
  for (Local i = 0; i < mesh.vertices.owned; ++i) {
    Vec3 product = residual_[i];
    for (const EdgeEnd& end : mesh.star_of(i)) product -= added_[end.edge] * (v[i] - v[end.other]);
    residual_[i] = dt * (b[i] - product);
  }
  set_.multipliers(rows_);
  set_.begin_spread(rows_);
  set_.end_spread(residual_);
  for (Local i = 0; i < mesh.vertices.owned; ++i) left_[i] = freedom_.allowed(i, residual_[i]);
}

/// Puts the tension of now in the matrix, in place of what is there.
template<ConstraintSetInNewton Set>
void NewtonStep<Set>::stiffen() {
  set_.tension_weights(weights_);
  auto slot = slots_.begin();
  for (Local i = 0; i < cloth_.mesh.vertices.owned; ++i)
    for (const EdgeEnd& end : cloth_.mesh.star_of(i))
      assembly_.system().stiffen(i, *slot++, weights_[end.edge] - added_[end.edge]);
  std::swap(weights_, added_);
}

/// What pins take is what is left where they hold.
template<ConstraintSetInNewton Set>
void NewtonStep<Set>::find_reaction(double dt, Candidate& candidate) const {
  for (Local i = 0; i < cloth_.mesh.vertices.owned; ++i)
    candidate.reported.reaction[i] = freedom_.denied(i, residual_[i]) / (-dt * dt);
}

template class NewtonStep<EdgeSet>;
template class NewtonStep<MetricSet>;
template class NewtonStep<MixedSet>;

} // namespace taut
