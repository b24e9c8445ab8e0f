#include "src/filters/impulse_contact.hpp"

#include "src/config/methods.hpp"
#include "src/contact/friction.hpp"
#include "src/contact/rows.hpp"
#include "src/linear/bounded_qp.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace taut {

namespace {

constexpr double recovered = 0.1;  ///< of what is missing to the thickness, in a step [Bridson et al. 2002]
constexpr int single_rounds = 10;  ///< of impulses on single pairs, before they make a zone
constexpr int most_products = 200; ///< in the program of a zone
constexpr double program_left = 1e-3; ///< of the thickness; pairs part by twice that, so that none closes
constexpr double nearest = 0.2;       ///< of their gap: how near two features may come in a step
constexpr double search_slack = 2.0;  ///< of the thickness: how far a target may stray unsearched

} // namespace

ImpulseContact::ImpulseContact(const Cloth& cloth, const Obstacles& obstacles, const Case& input)
    : scene_(cloth, obstacles), contact_(input.contact.value_or(config::Contact{})), thickness_(cloth, input),
      is_last_(config::contact_is_last(input)) {}

FilterReport ImpulseContact::apply(const State& start, double dt, const Freedom& freedom,
                                   Candidate& candidate) {
  const MPI_Comm comm = scene_.cloth().mesh.comm;
  const double began = MPI_Wtime();
  FilterReport report;
  begin(start, dt, freedom, candidate);
  const std::vector<Impact> near = too_near();
  report.contacts = sum_over(comm, Global(near.size()));
  report.contacts_if_even = size_of(comm) * max_over(comm, Global(near.size()));
  const auto is_across = [&](const Impact& impact) { return scene_.search.is_across(impact.vertices); };
  report.contacts_across = sum_over(comm, Global(std::ranges::count_if(near, is_across)));
  if (report.contacts > 0) push_apart(near);
  Zone zone; // all pairs that were found to meet
  for (int round = 1;; ++round) {
    if (scene_.search.follow(scene_.motion())) {
      update_pairs();
      zone.clear(); // its numbers were those of the pairs before
    }
    const std::vector<Impact> meeting = meetings(zone);
    const Global count = sum_over(comm, Global(meeting.size()));
    if (count == 0) break;
    if (round > single_rounds + contact_.max_iterations) {
      if (is_last_)
        report.failure = fmt::format("{} pairs would still meet after {} rounds of impulses", count, round);
      break;
    }
    ++report.iterations;
    if (round <= single_rounds)
      push_apart(meeting);
    else
      part_all(zone);
  }
  const auto &from = scene_.start().cloth, &to = scene_.target.cloth;
  for (std::size_t i = 0; i < to.size(); ++i) candidate.velocities[i] = (to[i] - from[i]) / dt;
  for (std::size_t i = 0; i < pushed_.size(); ++i)
    candidate.reported.contact_force[i] = pushed_[i] / (dt * dt);
  report.contact_seconds = MPI_Wtime() - began;
  return report;
}

void ImpulseContact::begin(const State& start, double dt, const Freedom& freedom,
                           const Candidate& candidate) {
  freedom_ = &freedom;
  scene_.begin(start, dt, candidate.velocities);
  scene_.restrict_to(freedom);
  pushed_.assign(scene_.cloth().mesh.vertices.owned, Vec3::Zero());
  scene_.search.find(scene_.motion(), thickness_.largest(), search_slack * thickness_.largest());
  update_pairs();
}

void ImpulseContact::update_pairs() {
  scene_.gather_start();
  take_displacements();
}

void ImpulseContact::take_displacements() {
  scene_.gather(scene_.target, displacement_);
  for (std::size_t i = 0; i < displacement_.size(); ++i) displacement_[i] -= scene_.start_field()[i];
}

/// Nothing, where nothing can be moved.
std::optional<ImpulseContact::Impact> ImpulseContact::impact(const Pair& pair, const Approach& approach,
                                                             double wanted) const {
  const double yields = scene_.inverse_effective_mass(pair, approach.weights);
  if (yields == 0) return {};
  const double friction = friction_of(pair, scene_.obstacles(), contact_);
  const Vec3 spin = scene_.spin(pair.body, approach.offset(pair));
  return Impact{pair.vertices, approach.weights, approach.normal, yields, wanted, friction, spin};
}

/// The pairs that are nearer than the thickness where the step starts.
std::vector<ImpulseContact::Impact> ImpulseContact::too_near() const {
  std::vector<Impact> found;
  for (const Pair& pair : scene_.search.pairs()) {
    const Approach here = approach(pair, at(pair, scene_.start_field()));
    const double violation = thickness_.of(pair, scene_.search.keys()) - here.gap;
    if (violation <= 0) continue;
    if (const auto pushed = impact(pair, here, recovered * violation)) found.push_back(*pushed);
  }
  return found;
}

/// The pairs that come too near on the way, as they stand when they do; they are added to the zone.
std::vector<ImpulseContact::Impact> ImpulseContact::meetings(Zone& zone) const {
  std::vector<Impact> found;
  for (const Pair& pair : scene_.search.pairs()) {
    Four x = at(pair, scene_.start_field());
    const Four u = at(pair, displacement_);
    const double thickness = thickness_.of(pair, scene_.search.keys());
    const double part = safe_fraction(pair, x, u, nearest * std::min(approach(pair, x).gap, thickness));
    if (part == 1) continue;
    for (int i = 0; i < 4; ++i) x[i] += part * u[i];
    const auto met = impact(pair, approach(pair, x), 2 * program_left * thickness);
    if (!met) continue;
    found.push_back(*met);
    zone[name_of(pair, scene_.search.keys())] = *met;
  }
  return found;
}

/// How far the features of an impact part, m.
Vec3 ImpulseContact::parting(const Impact& impact) const {
  return between(impact.vertices, impact.weights, displacement_);
}

/// Impulses on all of them at once.
void ImpulseContact::push_apart(std::span<const Impact> impacts) {
  std::vector<double> busy(scene_.search.size(), 0.0); // how many push a vertex
  for (const Impact& i : impacts)
    for (int k = 0; k < 4; ++k)
      if (i.weights[k] != 0) busy[i.vertices[k]] += 1;
  scene_.search.accumulate(busy);
  scene_.search.update(busy);
  std::vector<double> sizes;
  for (const Impact& i : impacts) {
    double most = 1;
    for (const Local v : i.vertices)
      if (scene_.can_move(v)) most = std::max(most, busy[v]);
    sizes.push_back(std::max(0.0, i.wanted - i.direction.dot(parting(i))) /
                    (i.inverse_effective_mass * most));
  }
  spread(impacts, sizes);
}

/// The least change of velocities after which no pair of the zone closes: minimise 1/2 |du|_M^2 subject to
/// direction . sum_i w_i (u + du)_i >= wanted [Harmon et al. 2008], by its multipliers.
void ImpulseContact::part_all(const Zone& zone) {
  std::vector<Impact> impacts;
  for (const auto& [name, met] : zone) impacts.push_back(met);
  const std::size_t n = impacts.size();
  std::vector<double> violation(n), sizes(n, 0.0), lower(n, 0.0), upper(n, HUGE_VAL),
      tolerance(n, program_left * thickness_.smallest());
  for (std::size_t k = 0; k < n; ++k)
    violation[k] = impacts[k].wanted - impacts[k].direction.dot(parting(impacts[k]));
  constexpr double compliance = 1e-3; // of a row's diagonal: rows may depend on one another
  const auto multiply = [&](std::span<const double> z, std::span<double> result) {
    std::vector<Vec3> field(scene_.search.size(), Vec3::Zero());
    for (std::size_t k = 0; k < n; ++k)
      for (int i = 0; i < 4; ++i)
        field[impacts[k].vertices[i]] += z[k] * impacts[k].weights[i] * impacts[k].direction;
    scene_.search.accumulate(field);
    for (Local i = 0; i < scene_.search.own(); ++i)
      field[i] = scene_.inverse_mass()[i] * freedom_->allowed(i, field[i]);
    std::fill(field.begin() + scene_.search.own(), field.begin() + scene_.search.home(), Vec3::Zero());
    scene_.search.update(field);
    for (std::size_t k = 0; k < n; ++k) {
      const Vec3 apart = between(impacts[k].vertices, impacts[k].weights, field);
      result[k] = impacts[k].direction.dot(apart) + compliance * impacts[k].inverse_effective_mass * z[k];
    }
  };
  const auto precondition = [&](std::span<const double> r, std::span<double> s) {
    for (std::size_t k = 0; k < n; ++k) s[k] = r[k] / impacts[k].inverse_effective_mass;
  };
  solve(scene_.cloth().mesh.comm, BoundedQp{multiply, precondition, violation, 0, lower, upper, tolerance},
        {most_products}, sizes);
  spread(impacts, sizes);
}

/// Moves the target by normal impulses of these sizes (kg m) and by the friction that goes with them: at most
/// what stops the slip.
void ImpulseContact::spread(std::span<const Impact> impacts, std::span<const double> sizes) {
  push_.assign(scene_.search.size(), Vec3::Zero());
  for (std::size_t k = 0; k < impacts.size(); ++k) {
    const Impact& i = impacts[k];
    if (sizes[k] <= 0) continue;
    Vec3 slip = parting(i) - i.spin;
    slip -= i.direction.dot(slip) * i.direction;
    const double stops = slip.norm() / i.inverse_effective_mass,
                 rubs = std::min(i.friction * sizes[k], stops);
    const Vec3 impulse =
        sizes[k] * i.direction - (stops > 0 ? rubs / stops : 0.0) / i.inverse_effective_mass * slip;
    for (int v = 0; v < 4; ++v) push_[i.vertices[v]] += i.weights[v] * impulse;
  }
  scene_.search.accumulate(push_);
  for (Local i = 0; i < scene_.search.own(); ++i) {
    pushed_[i] += push_[i];
    scene_.target.cloth[i] += scene_.inverse_mass()[i] * freedom_->allowed(i, push_[i]);
  }
  scene_.cloth().mesh.vertex_halo.update(scene_.target.cloth);
  take_displacements();
}

} // namespace taut
