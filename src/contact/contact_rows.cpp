#include "src/contact/contact_rows.hpp"

#include "src/contact/friction.hpp"

#include <Eigen/Geometry>
#include <boost/container/static_vector.hpp>

#include <algorithm>
#include <cmath>

namespace taut {

namespace {

constexpr double gap_left = 0.1; ///< by a program, of what a free vertex falls in a step
constexpr double close = 0.1;    ///< of the thickness, beyond it

/// Sine of the angle by which directions may be outside of a body's normal cones: by round-off, and for
/// contacts that are foreseen. Those that press at the end of a step must be known at its start. Where an
/// element of cloth rests on two corners of a body, it rocks otherwise: each step knows of one corner only,
/// and tilts the element into the other (src/newton/README.md#contact). What slides is held back by at most
/// that part of what presses.
constexpr double rounding = 1e-6, aslant_if_foreseen = 0.02;

constexpr double trails = 0.1; ///< of what a free vertex falls in the longest step: see anchor_reach_

} // namespace

ContactRows::ContactRows(ContactScene& scene, const SafeIterate& safe, const Thickness& thickness,
                         const config::Contact& options, double gravity, double longest_step)
    : scene_(scene), safe_(safe), thickness_(thickness), options_(options), cones_(scene.obstacles()),
      gravity_(gravity), anchor_reach_(trails * fall(longest_step)) {}

/// m that gravity moves a free vertex in a step, at most the smallest thickness.
double ContactRows::fall(double seconds) const {
  return gravity_ > 0 ? std::min(thickness_.smallest(), gravity_ * seconds * seconds) : thickness_.smallest();
}

void ContactRows::begin(const ContactMemory& memory, double dt, double overlap_kept) {
  dt_ = dt;
  overlap_kept_ = overlap_kept;
  fall_ = fall(dt);
  aslant_ = rounding;
  at_home_ = memory;
  known_.clear();
  seen_.clear();
}

void ContactRows::make(int iteration) {
  scene_.gather_target();
  find_contacts();
  rows_.clear();
  if (count_ > 0) {
    recall();
    drop_idle();
  }
  for (Local k = 0; k < Local(contacts_.size()); ++k) {
    turn_impulse(k);
    add_normal_row(k, iteration);
    add_friction_rows(k, iteration);
  }
}

std::vector<ForeseenContact> ContactRows::foresee() {
  scene_.gather_target();
  aslant_ = aslant_if_foreseen;
  corner_reach_ = fall_;
  find_contacts();
  corner_reach_ = 0;
  if (count_ > 0) recall();
  std::vector<ForeseenContact> foreseen;
  for (std::size_t k = 0; k < contacts_.size(); ++k)
    foreseen.push_back(
        {found_by_[k], contacts_[k], records_[k]->impulse, to_undo(Local(k)), tilts_of(contacts_[k])});
  return foreseen;
}

/// See ForeseenContact.
Tilts ContactRows::tilts_of(const Contact& contact) const {
  Tilts tilts{};
  if (contact.body < 0 || !scene_.obstacles().body(contact.body).is_round) return tilts;
  if (scene_.is_cloth(contact.vertices[0])) return tilts;
  boost::container::static_vector<int, 3> corners;
  for (int i = 1; i < 4; ++i)
    if (contact.weights[i] != 0 && scene_.is_cloth(contact.vertices[i])) corners.push_back(i);
  if (corners.size() < 2) return tilts;
  const auto x = [&](int i) -> const Vec3& { return safe_.field()[contact.vertices[i]]; };
  const Vec3 apart = between(contact.vertices, contact.weights, safe_.field());
  const double root = std::sqrt(std::max(0.0, contact.normal.dot(apart)));
  const Vec3 along = x(corners[1]) - x(corners[0]), first = along.normalized();
  tilts[0][corners[0]] = -root / along.norm();
  tilts[0][corners[1]] = root / along.norm();
  if (corners.size() < 3) return tilts;
  const Vec3 side = x(corners[2]) - x(corners[0]);
  const double part = side.dot(first), height = (side - part * first).norm();
  tilts[1][corners[2]] = root / height;
  tilts[1][corners[1]] = -root / height * part / along.norm();
  tilts[1][corners[0]] = -tilts[1][corners[2]] - tilts[1][corners[1]];
  return tilts;
}

void ContactRows::take(std::span<const ContactImpulse> impulses) {
  for (std::size_t k = 0; k < impulses.size(); ++k) {
    records_[k]->impulse = impulses[k].normal > 0 ? impulses[k] : ContactImpulse{};
    if (impulses[k].normal > 0) records_[k]->before = impulses[k].scaled(1 / (dt_ * dt_));
  }
}

void ContactRows::find_contacts() {
  contacts_.clear();
  records_.clear();
  found_by_.clear();
  unknown_.clear();
  ++round_;
  seen_.resize(scene_.search.pairs().size());
  for (std::size_t k = 0; k < scene_.search.pairs().size(); ++k) {
    const Pair& pair = scene_.search.pairs()[k];
    const Approach& here = safe_.approach_of(k);
    add_contact({pair, here, safe_.was_stopped_by(k)}, seen_[k]);
    const bool is_round = pair.body >= 0 && scene_.obstacles().body(pair.body).is_round;
    if (is_round && pair.kind == PairKind::vertex_face) add_corners(pair, here);
  }
  count_ = sum_over(scene_.cloth().mesh.comm, Global(contacts_.size()));
}

/// The gap at other positions, as far as the features keep their direction.
double ContactRows::gap_along(const Pair& pair, const Approach& here, std::span<const Vec3> field) const {
  return here.normal.dot(between(pair.vertices, here.weights, field)) - pair.radius;
}

double ContactRows::gap_wanted(const Pair& pair, const Approach& here) const {
  const double thickness = thickness_.of(pair, scene_.search.keys());
  if (overlap_kept_ == 0) return thickness;
  return thickness - overlap_kept_ * std::max(0.0, thickness - gap_along(pair, here, scene_.start_field()));
}

/// Of what is near a round obstacle, faces and edges are contacts. (Vertices alone would be half the rows,
/// but friction then chatters: the capstan's force comes out half as large again.)
void ContactRows::add_contact(const Sight& sight, Seen& seen) {
  const auto& [pair, here, has_stopped] = sight;
  const std::span<const Global> keys = scene_.search.keys();
  const double gap = gap_along(pair, here, scene_.target_field());
  const double nearest = std::min(gap, here.gap);
  const bool is_near = nearest < thickness_.largest_near() && nearest < thickness_.near(pair, keys);
  if (!is_near && !has_stopped) return;
  const bool inside =
      here.weights[0] != 0 && here.weights[1] != 0 && here.weights[2] != 0 && here.weights[3] != 0;
  const bool is_covered = // vertices against faces have it, or the next triangle of the obstacle
      (pair.kind == PairKind::edge_edge && !inside) ||
      (pair.body >= 0 && !cones_.holds(pair, here, safe_.field(), scene_.search.own(), aslant_));
  if (is_covered && !has_stopped) return;
  const double yields = scene_.inverse_effective_mass(pair, here.weights);
  if (yields == 0) return; // nothing here can be moved
  auto& [key, record] = known_as(pair, here, seen);
  const int last_round = std::exchange(record.round, round_);
  if (last_round == round_) return; // another pair has found it
  const double violation = gap_wanted(pair, here) - gap;
  const bool is_close = violation > -close * thickness_.of(pair, keys) || has_stopped;
  if (last_round > 0 && !is_close && !record.has_pressed()) return; // see drop_idle
  contacts_.push_back({pair.vertices, here.weights, here.normal, yields, violation, key,
                       friction_of(pair, scene_.obstacles(), options_), pair.body, is_close});
  records_.push_back(&record);
  found_by_.push_back(pair);
}

/// What is known of the contact that a pair is now: asked for by name only where its features are not those
/// that they were, for names are costly.
ContactRows::Known::value_type& ContactRows::known_as(const Pair& pair, const Approach& here, Seen& seen) {
  unsigned features = 0;
  for (int i = 0; i < 4; ++i) features |= unsigned(here.weights[i] != 0) << i;
  if (seen.contact && seen.features == features) return *seen.contact;
  const auto [known, is_new] = known_.try_emplace(key_of(pair, here, scene_.search.keys()));
  if (is_new) unknown_.push_back(known->first);
  seen = {features, &*known}; // which stays where it is
  return *known;
}

/// Vertices of cloth that are about to press on a sphere though all around them is nearer to it now, and so
/// alone is in the pairs: without a row of their own, what pulls them in goes unopposed. (Along a capsule
/// edges of cloth are in the pairs; with rows of vertices beside theirs the capstan's force came out larger.)
void ContactRows::add_corners(const Pair& pair, const Approach& here) {
  for (int i = 1; i < 4; ++i) {
    if (here.weights[i] == -1) continue; // the pair is this contact
    Pair corner = pair;
    corner.kind = PairKind::vertex_edge; // an edge of no length
    std::fill(corner.vertices.begin() + 1, corner.vertices.end(), pair.vertices[i]);
    const Approach alone = approach(corner, at(corner, safe_.field()));
    const double gap = std::min(alone.gap, gap_along(corner, alone, scene_.target_field()));
    if (gap < thickness_.of(pair, scene_.search.keys()) + corner_reach_) {
      Seen never;
      add_contact({corner, alone}, never);
    }
  }
}

/// Fetches what the last step left of contacts that are the first time in this one, and lets them start from
/// it.
void ContactRows::recall() {
  for (const auto& [key, entry] : hand_out(scene_.cloth().mesh, at_home_, unknown_)) {
    ContactRecord& record = known_.at(key);
    record.impulse = entry.carried.scaled(dt_ * dt_);
    record.before = entry.pressed;
    record.drift = entry.drift;
  }
}

/// Leaves the contacts that may press: in a stack of layers one in four. If a program brings another one too
/// near it has a row in the next iteration.
void ContactRows::drop_idle() {
  std::size_t kept = 0;
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    if (!contacts_[k].is_close && !records_[k]->has_pressed()) continue;
    contacts_[kept] = contacts_[k];
    records_[kept++] = records_[k];
  }
  contacts_.resize(kept);
  records_.resize(kept);
  count_ = sum_over(scene_.cloth().mesh.comm, Global(kept));
}

/// What has pressed and rubbed a contact, told by the normal that it has now.
void ContactRows::turn_impulse(Local k) {
  ContactImpulse& impulse = records_[k]->impulse;
  const Vec3& normal = contacts_[k].normal;
  const double along = normal.dot(impulse.tangent);
  impulse.normal = std::max(0.0, impulse.normal + along);
  impulse.tangent -= along * normal;
}

void ContactRows::add_normal_row(Local k, int iteration) {
  const Contact& contact = contacts_[k];
  const ContactRecord& record = *records_[k];
  const double so_far = record.impulse.normal;
  const double before = record.before ? dt_ * dt_ * record.before->normal : 0.0;
  const double guess = iteration == 1 ? std::max(-so_far, before - so_far) : 0.0;
  rows_.push_back({k, true, contact.normal, contact.violation, -so_far, HUGE_VAL, gap_left * fall_, guess});
}

bool ContactRows::are_met() const {
  const auto is_too_near = [](const ContactRow& row) {
    return row.is_normal && !(row.violation <= row.slack);
  };
  return !any_of(scene_.cloth().mesh.comm, std::ranges::any_of(rows_, is_too_near));
}

void ContactRows::add(std::span<const double> z) {
  for (std::size_t k = 0; k < rows_.size(); ++k) {
    ContactImpulse& impulse = records_[rows_[k].contact]->impulse;
    if (rows_[k].is_normal)
      impulse.normal = std::max(0.0, impulse.normal + z[k]);
    else
      impulse.tangent += z[k] * rows_[k].direction;
  }
}

/// Per dt^2, newtons: what has pressed a contact in this step, and what of it lasts.
ContactEntry ContactRows::entry_of(const ContactRecord& record) const {
  const ContactImpulse now = record.impulse.scaled(1 / (dt_ * dt_));
  return {now, record.before ? lasting(*record.before, now) : ContactImpulse{}, record.drifted};
}

void ContactRows::report_forces(Candidate& candidate) const {
  auto &carried_forces = candidate.multipliers.carried_contact_force,
       &forces = candidate.reported.contact_force;
  std::fill(carried_forces.begin(), carried_forces.end(), Vec3::Zero());
  std::fill(forces.begin(), forces.end(), Vec3::Zero());
  if (count_ == 0) return;
  const ContactSearch& search = scene_.search;
  std::vector<Vec3> lasting_part(search.size(), Vec3::Zero()), whole = lasting_part;
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    const Contact& contact = contacts_[k];
    if (records_[k]->impulse.normal <= 0) continue;
    const auto [now, carried, drift] = entry_of(*records_[k]);
    for (int i = 0; i < 4; ++i) {
      lasting_part[contact.vertices[i]] +=
          contact.weights[i] * (carried.normal * contact.normal + carried.tangent);
      whole[contact.vertices[i]] += contact.weights[i] * (now.normal * contact.normal + now.tangent);
    }
  }
  search.accumulate(lasting_part);
  search.accumulate(whole);
  std::copy_n(lasting_part.begin(), search.own(), carried_forces.begin());
  std::copy_n(whole.begin(), search.own(), forces.begin());
  scene_.cloth().mesh.vertex_halo.update(carried_forces);
}

ContactMemory ContactRows::memory() const {
  ContactMemory::sequence_type entries;
  for (std::size_t k = 0; k < contacts_.size(); ++k)
    if (records_[k]->impulse.normal > 0) entries.emplace_back(contacts_[k].key, entry_of(*records_[k]));
  std::sort(entries.begin(), entries.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  ContactMemory pressed;
  pressed.adopt_sequence(boost::container::ordered_unique_range, std::move(entries));
  return bring_home(scene_.cloth().mesh, pressed);
}

} // namespace taut
