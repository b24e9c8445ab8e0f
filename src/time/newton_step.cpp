#include "src/time/newton_step.hpp"

#include "partition/traffic.hpp"
#include "src/constraints/mixed_set.hpp"
#include "src/constraints/projection_options.hpp"
#include "src/linear/kkt_system.hpp"
#include "src/time/added_pull.hpp"
#include "src/time/make_contact_projection.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>

namespace taut {

namespace {

constexpr int most_iterations = 100; // of a solve
constexpr int most_iterations_in_contact =
    40;                        // where what a solve leaves, as in a crumpling pile, the next takes
constexpr double turned = 0.1; // strain that says that edges have turned much

} // namespace

template<ConstraintSetInNewton Set>
NewtonStep<Set>::NewtonStep(const StepperParts& parts, const Case& input)
    : cloth_(parts.cloth), pins_(parts.pins), options_(parts.resolved.inextensibility),
      gravity_(input.gravity.largest() > 0 ? input.gravity.largest() : 1.0), weight_(parts.resolved.weight),
      longest_step_(input.time.max_step), integrator_(input.time.integrator),
      assembly_(parts.cloth, parts.pattern, parts.forces, input.time.integrator),
      set_(parts.cloth, options_, ConstraintUse::in_newton),
      solver_(parts.cloth, parts.pattern, set_, solver_options(options_).kind),
      contact_(input.contact_model() == config::ContactModel::constraint
                   ? make_contact_projection<Bounded<Set>>(parts, input)
                   : nullptr),
      triangles_(contact_ && parts.resolved.faces_limit
                     ? std::optional<TrianglePenalty>(std::in_place, parts.cloth, options_)
                     : std::nullopt),
      stiffness_(parts.cloth.mesh), freedom_(parts.cloth.mesh.vertices.size()),
      slots_(edge_slots(parts.cloth.mesh, parts.pattern)), weights_(parts.cloth.mesh.edges.size()),
      added_(weights_), rows_(set_.rows()), change_(rows_), kept_(rows_),
      residual_(parts.cloth.mesh.vertices.size()), left_(parts.cloth.mesh.vertices.owned), dx_(residual_),
      moved_(left_) {}

template<ConstraintSetInNewton Set>
StepReport NewtonStep<Set>::propose(const State& state, double dt, Candidate& candidate) {
  const StepStart start = integrator_.start(state, dt);
  StepReport report;
  begin(start, candidate);
  if (contact_) report += contact_->foresee(start.state, dt, freedom_, candidate.velocities);
  find_resistance();
  iterate(start, candidate, report);
  set_.finish(candidate);
  find_reaction(start.dt, candidate);
  if (contact_ && report.failure.empty()) correct(start, candidate, report);
  return report;
}

template<ConstraintSetInNewton Set>
void NewtonStep<Set>::begin(const StepStart& start, Candidate& candidate) {
  const PhaseScope phase(Phase::velocity);
  candidate.velocities = start.state.velocities;
  pins_.prescribe(start.state, start.dt, freedom_, candidate.velocities);
  assembly_.assemble(start);
  stiffness_.set(assembly_.system().matrix(), freedom_);
  solver_.begin_step();
  std::fill(added_.begin(), added_.end(), 0.0);
  if (options_.carried_tension) candidate.multipliers.force_density = start.state.multipliers.force_density;
  set_.start(start.state, start.dt, freedom_, candidate);
  keep_violation(start);
}

/// How hard contacts and triangles are, from the system with the tension that the step begins with.
template<ConstraintSetInNewton Set>
void NewtonStep<Set>::find_resistance() {
  if (!triangles_ && !has_contacts()) return;
  const PhaseScope phase(Phase::velocity);
  stiffen();
  const std::vector<double> inverse = metric();
  if (triangles_) triangles_->begin(inverse);
  if (has_contacts()) contact_->foreseen().set_metric(inverse);
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
  for (bool is_solved = false;; is_solved = true) {
    const double strain = project(start, candidate, report);
    if (!report.failure.empty()) return;
    find_residual(start.dt, candidate);
    set_.residual(rows_);
    for (std::size_t row = 0; row < rows_.size(); ++row) rows_[row] -= kept_[row];
    const double unit = unit_of_movement(start, candidate);
    const bool may_end = is_solved && strain <= options_.strain && is_settled(start.dt);
    const bool must_end = !std::isfinite(strain) || report.iterations >= options_.max_iterations;
    report.residual = is_solved && (may_end || must_end) ? solver_.movement(left_) / unit : 0.0;
    if (may_end && report.residual <= options_.residual) return;
    if (must_end || !std::isfinite(report.residual)) {
      report.failure =
          fmt::format("Newton's method left a strain of {:.3g} and a residual of {:.3g} after {} "
                      "solves and projections (limits {:g} and {:g})",
                      strain, report.residual, report.iterations, options_.strain, options_.residual);
      return;
    }
    if (!solve(start.dt, unit, candidate, report)) return;
  }
}

/// Whether contacts agree, or need not. Collective.
template<ConstraintSetInNewton Set>
bool NewtonStep<Set>::is_settled(double dt) const {
  return !has_contacts() || contact_->foreseen().is_settled() || is_balanced(dt);
}

/// Whether the forces that are left, all together, are so small a part of the weight that it makes no
/// difference which contacts press: a tenth, as the residual, and of their sum, by which what slides as a
/// whole would slide too fast or too slowly, a tenth of that. How far they would move the cloth does not
/// tell: contacts are stiff. Collective.
template<ConstraintSetInNewton Set>
bool NewtonStep<Set>::is_balanced(double dt) const {
  constexpr double part_of_sum = 0.1;
  double norms = 0;
  Vec3 sum = Vec3::Zero();
  for (const Vec3& r : left_) norms += r.norm(), sum += r;
  norms = sum_over(cloth_.mesh.comm, norms);
  for (double& component : sum) component = sum_over(cloth_.mesh.comm, component);
  const double most = options_.residual * weight_ * dt * dt;
  return norms <= most && sum.norm() <= part_of_sum * most;
}

/// Where edges have turned much: see the header. Returns the strain that is left.
template<ConstraintSetInNewton Set>
double NewtonStep<Set>::project(const StepStart& start, Candidate& candidate, StepReport& report) {
  set_positions(start, candidate);
  double strain = set_.evaluate(candidate.positions);
  if (strain <= turned) return strain;
  for (double before = HUGE_VAL; strain > options_.strain && strain < before;) {
    const SolveReport solved = set_.solve(forcing(strain, options_.strain));
    ++report.iterations;
    report.linear_iterations += solved.iterations;
    if (!solved.failure.empty()) {
      report.failure = "the projection's linear solver failed: " + solved.failure;
      return strain;
    }
    for (Local i = 0; i < cloth_.mesh.vertices.owned; ++i)
      candidate.velocities[i] -= set_.displacement(i) / start.dt;
    cloth_.mesh.vertex_halo.update(candidate.velocities);
    set_positions(start, candidate);
    before = std::exchange(strain, set_.evaluate(candidate.positions));
  }
  return strain;
}

/// How far gravity moves the cloth in the step, or what accelerates it more so far; root mean square, in m.
template<ConstraintSetInNewton Set>
double NewtonStep<Set>::unit_of_movement(const StepStart& start, const Candidate& candidate) {
  for (std::size_t i = 0; i < dx_.size(); ++i)
    dx_[i] = start.dt * (candidate.velocities[i] - start.state.velocities[i]);
  return std::max(gravity_ * start.dt * start.dt, solver_.rms(dx_));
}

/// Whether there is a change to go on from. What slows down moves less than gravity would move it, and what
/// solves leave must shrink with that, or the cloth trembles for ever.
template<ConstraintSetInNewton Set>
bool NewtonStep<Set>::solve(double dt, double unit, Candidate& candidate, StepReport& report) {
  constexpr double part_of_limit = 0.1, part_of_strain = 0.3; // what turns comes on top
  constexpr double steps = 2; // in which it moves as far; with 3 what rests loses it (src/newton/README.md)
  constexpr double still = 1e-3; // of the unit: what stands still
  stiffen();
  if (has_contacts()) assembly_.system().set_far(contact_->foreseen().couplings());
  if (triangles_) assembly_.system().set_near(triangles_->terms(candidate.positions));
  solver_.factor(stiffness_);
  const double part = part_of_limit * options_.residual;
  for (std::size_t i = 0; i < moved_.size(); ++i) moved_[i] = dt * candidate.velocities[i];
  const double least = part * std::clamp(steps * solver_.rms(moved_), still * unit, unit);
  const SolveReport solved =
      solver_.solve(left_, rows_, {least, part * unit, moved_, part_of_strain},
                    contact_ ? most_iterations_in_contact : most_iterations, dx_, change_);
  ++report.iterations;
  report.linear_iterations += solved.iterations;
  if (!solved.failure.empty()) {
    report.failure = "the factor of Newton's linear system failed: " + solved.failure;
    return false;
  }
  if (solved.iterations == most_iterations && !contact_) {
    report.failure = fmt::format("Newton's linear solver did not converge in {} iterations", most_iterations);
    return false;
  }
  if (has_contacts()) shorten_change();
  for (std::size_t i = 0; i < dx_.size(); ++i) candidate.velocities[i] += dx_[i] / dt;
  set_.add(change_);
  return true;
}

/// To what can be taken of the change before contacts turn it round.
template<ConstraintSetInNewton Set>
void NewtonStep<Set>::shorten_change() {
  double power = 0;
  for (std::size_t i = 0; i < left_.size(); ++i) power += left_[i].dot(dx_[i]);
  const double part = contact_->foreseen().step_length(dx_, sum_over(cloth_.mesh.comm, power));
  for (Vec3& x : dx_) x *= part;
  for (double& m : change_) m *= part;
}

/// h (b - A v) - J^T mu at owned vertices, for the matrix A without tension's part.
template<ConstraintSetInNewton Set>
void NewtonStep<Set>::find_residual(double dt, const Candidate& candidate) {
  const std::span<const Vec3> v = candidate.velocities;
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
  if (has_contacts()) contact_->foreseen().evaluate(v, residual_);
  if (triangles_) triangles_->evaluate(candidate.positions, v, dt, residual_);
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

/// Inverse, of the system as it is, 1/kg of local vertices, 0 if held.
template<ConstraintSetInNewton Set>
std::vector<double> NewtonStep<Set>::metric() const {
  std::vector<double> metric(cloth_.mesh.vertices.size());
  stiffness_.inverse_means(metric);
  return metric;
}

/// What pins take is what is left where they hold.
template<ConstraintSetInNewton Set>
void NewtonStep<Set>::find_reaction(double dt, Candidate& candidate) const {
  for (Local i = 0; i < cloth_.mesh.vertices.owned; ++i)
    candidate.reported.reaction[i] = freedom_.denied(i, residual_[i]) / (-dt * dt);
}

/// What contact still asks for, and what pins take of that.
template<ConstraintSetInNewton Set>
void NewtonStep<Set>::correct(const StepStart& start, Candidate& candidate, StepReport& report) {
  const PhaseScope phase(Phase::projection);
  const std::vector<double> before = candidate.multipliers.force_density;
  const FilterReport corrected = contact_->correct(start.state, start.dt, freedom_, candidate);
  report += corrected;
  report.failure = corrected.failure;
  set_positions(start, candidate);
  for (Local i = 0; i < cloth_.mesh.vertices.owned; ++i)
    if (!freedom_.is_free(i))
      candidate.reported.reaction[i] -= freedom_.denied(i, added_pull(cloth_.mesh, i, before, candidate));
}

template class NewtonStep<EdgeSet>;
template class NewtonStep<MetricSet>;
template class NewtonStep<MixedSet>;

} // namespace taut
