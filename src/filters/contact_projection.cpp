#include "src/filters/contact_projection.hpp"

#include "partition/traffic.hpp"
#include "src/constraints/bounded_set.hpp"
#include "src/state/told_apart.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace taut {

namespace {

/// Of a program; what is left waits for the next iteration. While the largest strain is `far` limits, the
/// constraints' curvature leaves more of it than so few products do. Nearer, the step is done if no row is
/// left beyond the limit.
constexpr QpEffort effort_far{20}, effort_near{40, 80, 0.8 / program_strain_left};

/// Of the same program with friction bounded by the normal forces that it found. (Cut off without any such
/// round, friction leaves so much strain that an impact on cases/sphere takes three times the iterations;
/// without what is too low in its bounds made good, patches slide too fast.)
constexpr QpEffort effort_again{10};

/// Near, of the same with friction cut off to Coulomb's cones before and kept in them: what a cut leaves of
/// strain at the end, in a stack of layers two and a half limits, has to be projected anew.
constexpr QpEffort effort_in_cones{5, 40, effort_near.good_enough};

constexpr double far = 10.0;

/// Strain of a target that is no shape of the cloth yet: where programs will lead from it, it hardly tells.
/// (With 0.3 the folds of five sheets take 4.4 projections instead of 4.1, with `far` limits cases/capstan a
/// twelfth more.)
constexpr double shapeless = 0.5;

constexpr double slack = 1.0;      ///< of the thickness: how far cloth may stray before a search is extended
constexpr int patience = 6;        ///< iterations until stuck vertices are let go
constexpr double most_strain = 30; ///< of a prediction; what moves farther could not be searched

/// Of the longest step: the time in which what strain and overlap a step leaves are corrected. Within a much
/// shorter step that would throw the cloth about.
constexpr double settling = 0.25;

/// Runs a part of the work on contact, on the clock of the report.
template<class Part>
void timed(FilterReport& report, Part&& part) {
  const PhaseScope phase(Phase::contact);
  const double began = MPI_Wtime();
  part();
  report.contact_seconds += MPI_Wtime() - began;
}

} // namespace

template<ConstraintSet Set>
ContactProjection<Set>::ContactProjection(const Cloth& cloth, const Obstacles& obstacles, Thickness thickness,
                                          const ContactProjectionOptions& options)
    : options_(options), thickness_(std::move(thickness)), scene_(cloth, obstacles, options.strings),
      safe_(scene_, thickness_),
      rows_(scene_, safe_, thickness_, options_.contact, options.gravity, options.longest_step),
      foreseen_(scene_), alone_(cloth, options.limits),
      set_(cloth, options.limits, ConstraintUse::with_contact), qp_(cloth, scene_.search) {}

template<ConstraintSet Set>
FilterReport ContactProjection<Set>::apply(const State& start, double dt, const Freedom& freedom,
                                           Candidate& candidate) {
  FilterReport report;
  begin(start, dt, freedom, candidate.velocities);
  guess_ = QpGuess::last_step;
  if (is_torn(set_.strain(scene_.target.cloth), report)) return report;
  timed(report, [&] { find_pairs(); });
  rows_.make(1);
  iterate(start, dt, freedom, candidate, report);
  return report;
}

template<ConstraintSet Set>
FilterReport ContactProjection<Set>::foresee(const State& start, double dt, const Freedom& freedom,
                                             std::span<const Vec3> velocities) {
  FilterReport report;
  begin(start, dt, freedom, velocities);
  timed(report, [&] {
    find_pairs();
    scene_.target.cloth = start.positions;
    foreseen_.begin(rows_.foresee(), dt);
  });
  return report;
}

template<ConstraintSet Set>
FilterReport ContactProjection<Set>::correct(const State& start, double dt, const Freedom& freedom,
                                             Candidate& candidate) {
  FilterReport report;
  rows_.take(foreseen_.impulses());
  guess_ = QpGuess::zero;
  for (std::size_t i = 0; i < candidate.velocities.size(); ++i)
    scene_.target.cloth[i] = start.positions[i] + dt * candidate.velocities[i];
  const double strain = set_.strain(scene_.target.cloth);
  if (is_torn(strain, report)) return report;
  timed(report, [&] {
    if (scene_.search.follow(safe_.motion())) update_pairs(scene_.search.kept());
  });
  rows_.make(1);
  if (is_kept(strain, report)) {
    note_contacts(candidate);
    count_contacts(report);
    candidate.multipliers.contacts = rows_.memory();
  } else {
    iterate(start, dt, freedom, candidate, report);
  }
  return report;
}

/// Whether nothing is left to correct of a candidate that strains so much. A projection would leave an
/// equilibrium of all equations what its own metric makes of it.
template<ConstraintSet Set>
bool ContactProjection<Set>::is_kept(double strain, FilterReport& report) {
  if (!(strain <= options_.limits.strain) || !rows_.are_met()) return false;
  double fraction = 0;
  timed(report, [&] {
    fraction = safe_.safe_fraction_to_target();
    if (fraction == 1) report.smallest_gap = safe_.smallest_gap_at_target();
  });
  return fraction == 1;
}

/// Whether a target that strains so much is too far from any shape that the cloth can have.
template<ConstraintSet Set>
bool ContactProjection<Set>::is_torn(double strain, FilterReport& report) {
  if (strain <= most_strain) return false; // and not where it is no number
  report.failure = fmt::format("without projection edges would strain by {:.3g}", strain);
  return true;
}

template<ConstraintSet Set>
void ContactProjection<Set>::iterate(const State& start, double dt, const Freedom& freedom,
                                     Candidate& candidate, FilterReport& report) {
  if (rows_.count() == 0 && ends_alone(start, dt, freedom, candidate, report)) return;
  set_.start(start, dt, freedom, candidate);
  for (iteration_ = 1;; rows_.make(++iteration_)) {
    report.failure = project(report);
    count_contacts(report);
    if (!report.failure.empty()) break;
    const double asked = set_.strain(scene_.target.cloth);
    const bool is_last = iteration_ == options_.contact.max_iterations;
    // Noted before another search renumbers what the rows refer to.
    if (asked <= options_.limits.strain || is_last) note_contacts(candidate);
    if (ends_after_moving(asked, report)) break;
  }
  propose(start, dt, candidate);
}

template<ConstraintSet Set>
void ContactProjection<Set>::begin(const State& start, double dt, const Freedom& freedom,
                                   std::span<const Vec3> velocities) {
  const double kept = std::max(0.0, 1 - dt / (settling * options_.longest_step));
  scene_.begin(start, dt, velocities);
  scene_.restrict_to(freedom);
  safe_.begin();
  rows_.begin(start.multipliers.contacts, dt, kept);
  set_.keep_strain(kept);
  behind_ = HUGE_VAL;
}

template<ConstraintSet Set>
void ContactProjection<Set>::find_pairs() {
  scene_.search.find(safe_.motion(), thickness_.largest_near(), slack * thickness_.largest());
  update_pairs(0);
}

/// Of which the first `known` were there when gaps were last measured.
template<ConstraintSet Set>
void ContactProjection<Set>::update_pairs(std::size_t known) {
  scene_.gather_start();
  safe_.keep_pairs(known);
  safe_.measure_gaps(known);
  rows_.keep_pairs(known);
}

/// Fast Projection, where no contact is in reach; false if it would lead to one.
template<ConstraintSet Set>
bool ContactProjection<Set>::ends_alone(const State& start, double dt, const Freedom& freedom,
                                        Candidate& candidate, FilterReport& report) {
  Candidate alone = candidate;
  const FilterReport projected = alone_.apply(start, dt, freedom, alone);
  report += projected;
  if (projected.failure.empty()) {
    std::swap(scene_.target.cloth, alone.positions);
    double fraction = 0;
    timed(report, [&] {
      if (scene_.search.follow(safe_.motion())) update_pairs(scene_.search.kept());
      fraction = safe_.safe_fraction_to_target();
    });
    rows_.make(1);
    if (fraction < 1 || rows_.count() > 0) {
      std::swap(scene_.target.cloth, alone.positions);
      rows_.make(1);
      return false;
    }
    timed(report, [&] { report.smallest_gap = safe_.smallest_gap_at_target(); });
  }
  report.failure = projected.failure;
  report.too_costly = projected.too_costly;
  candidate = std::move(alone);
  return true;
}

/// Moves the target to where constraints and contacts want it; returns why it cannot.
template<ConstraintSet Set>
std::string ContactProjection<Set>::project(FilterReport& report) {
  std::vector<Vec3>& target = scene_.target.cloth;
  const double strain = set_.evaluate(target), limit = options_.limits.strain;
  if (!std::isfinite(strain)) return "the positions are no longer finite";
  ++report.iterations;
  const bool is_far = strain > far * limit;
  const QpEffort& effort = is_far ? effort_far : effort_near;
  report.linear_iterations +=
      qp_.solve(set_, rows_.contacts(), rows_.rows(), effort, std::exchange(guess_, QpGuess::zero)).products;
  const auto by_normals = [this](auto z, auto lower, auto upper) { rows_.limit_friction(z, lower, upper); };
  report.linear_iterations += qp_.solve_on(effort_again, by_normals).products;
  const auto by_cones = [this](auto z, auto lower, auto upper) { rows_.stay_in_cones(z, lower, upper); };
  if (!is_far) report.linear_iterations += qp_.solve_on(effort_in_cones, by_cones).products;
  rows_.keep_in_cones(qp_.row_part());
  const auto push = qp_.push();
  for (std::size_t i = 0; i < push.size(); ++i) target[i] += push[i];
  set_.add(qp_.set_part());
  rows_.add(qp_.row_part());
  return "";
}

template<ConstraintSet Set>
void ContactProjection<Set>::note_contacts(Candidate& candidate) {
  rows_.note_drift();
  rows_.report_forces(candidate);
}

template<ConstraintSet Set>
void ContactProjection<Set>::count_contacts(FilterReport& report) const {
  if (rows_.count() <= report.contacts) return;
  const MPI_Comm comm = scene_.cloth().mesh.comm;
  report.contacts = rows_.count();
  report.contacts_if_even = size_of(comm) * max_over(comm, Global(rows_.contacts().size()));
  const auto is_across = [&](const Contact& contact) { return scene_.search.is_across(contact.vertices); };
  report.contacts_across = sum_over(comm, Global(std::ranges::count_if(rows_.contacts(), is_across)));
}

/// Moves the safe iterate towards the target, which is strained by `asked`; true if the step ends there, or
/// cannot. A target without shape is not worth the search for what is on the way: it is only projected again.
template<ConstraintSet Set>
bool ContactProjection<Set>::ends_after_moving(double asked, FilterReport& report) {
  const bool may_go_on = iteration_ < options_.contact.max_iterations;
  const double limit = options_.limits.strain;
  if (may_go_on && asked > std::max(shapeless, limit)) return false;
  double fraction = 1;
  timed(report, [&] {
    if (scene_.search.follow(safe_.motion())) update_pairs(scene_.search.kept());
    fraction = safe_.safe_fraction_to_target();
  });
  safe_.move(fraction);
  const double strain = set_.strain(safe_.cloth());
  if (fraction == 1.0 && strain <= limit) {
    timed(report, [&] { report.smallest_gap = safe_.smallest_gap_at_target(); });
    return true;
  }
  if (iteration_ == options_.contact.max_iterations) {
    const std::string stopped = safe_.what_stopped();
    report.failure = fmt::format(
        "projection with contact left a strain of {} (limit {:g}) after {} iterations{}{}",
        told_apart(strain, limit), limit, iteration_, stopped.empty() ? "" : " and was stopped by ", stopped);
    return true;
  }
  timed(report, [&] { safe_.measure_gaps(0); });
  const double was_behind = std::exchange(behind_, safe_.distance_behind());
  if (fraction < 1 && iteration_ >= patience && behind_ > 0.5 * was_behind) safe_.release_stuck();
  return false;
}

template<ConstraintSet Set>
void ContactProjection<Set>::propose(const State& start, double dt, Candidate& candidate) const {
  for (std::size_t i = 0; i < candidate.velocities.size(); ++i)
    candidate.velocities[i] = (safe_.cloth()[i] - start.positions[i]) / dt;
  set_.finish(candidate);
  candidate.multipliers.contacts = rows_.memory();
}

template class ContactProjection<EdgeSet>;
template class ContactProjection<MetricSet>;
template class ContactProjection<BoundedSet<MetricSet>>;
template class ContactProjection<BoundedSet<MixedSet>>;
template class ContactProjection<MixedSet>;

} // namespace taut
