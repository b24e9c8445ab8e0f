// The rows of a contact projection: what presses and rubs, from step to step and within one.
#include "src/filters/contact_projection.hpp"

#include "src/contact/friction.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace taut {

namespace {

constexpr double gap_left = 0.1;   ///< by a program, of what a free vertex falls in a step
constexpr double slip_left = 0.03; ///< the same

} // namespace

/// Per dt^2, newtons: what has pressed a contact in this step, and what of it lasts.
ContactEntry ContactProjection::entry_of(const ContactRecord& touch) const {
  const ContactImpulse now = touch.pressed.scaled(1 / (dt_ * dt_));
  return {now, touch.before ? lasting(*touch.before, now) : ContactImpulse{}};
}

/// What the contacts there are press and carry, as forces on vertices.
void ContactProjection::note_contact_forces(Candidate& candidate) {
  candidate.multipliers.carried_contact_force.assign(candidate.multipliers.carried_contact_force.size(),
                                                     Vec3::Zero());
  candidate.reported.contact_force.assign(candidate.reported.contact_force.size(), Vec3::Zero());
  if (contact_count_ == 0) return;
  std::vector<Vec3> lasting_forces(search_.size(), Vec3::Zero()), all_forces = lasting_forces;
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    const Contact& contact = contacts_[k];
    if (touches_[k]->pressed.normal <= 0) continue;
    const auto [now, carried] = entry_of(*touches_[k]);
    for (int i = 0; i < 4; ++i) {
      lasting_forces[contact.vertices[i]] +=
          contact.weights[i] * (carried.normal * contact.normal + carried.tangent);
      all_forces[contact.vertices[i]] += contact.weights[i] * (now.normal * contact.normal + now.tangent);
    }
  }
  search_.accumulate(lasting_forces);
  search_.accumulate(all_forces);
  std::copy_n(lasting_forces.begin(), search_.own(), candidate.multipliers.carried_contact_force.begin());
  std::copy_n(all_forces.begin(), search_.own(), candidate.reported.contact_force.begin());
  cloth_.mesh.vertex_halo.update(candidate.multipliers.carried_contact_force);
}

/// For the next step.
ContactMemory ContactProjection::pressed_contacts() const {
  ContactMemory pressed;
  pressed.reserve(contacts_.size());
  for (std::size_t k = 0; k < contacts_.size(); ++k)
    if (touches_[k]->pressed.normal > 0)
      pressed.emplace_hint(pressed.end(), contacts_[k].key, entry_of(*touches_[k]));
  return pressed;
}

void ContactProjection::make_rows() {
  search_.gather(target_.cloth, target_.obstacles, target_field_);
  find_contacts();
  rows_.clear();
  if (contact_count_ > 0) recall_contacts();
  for (Local k = 0; k < Local(contacts_.size()); ++k) {
    add_normal_row(k);
    add_friction_rows(k);
  }
}

void ContactProjection::find_contacts() {
  contacts_.clear();
  for (std::size_t k = 0; k < search_.pairs().size(); ++k) {
    const Pair& pair = search_.pairs()[k];
    add_contact(pair, approaches_[k]);
    const bool is_round = pair.body >= 0 && obstacles_.body(pair.body).is_round;
    if (is_round && pair.kind == PairKind::vertex_face) add_corners(pair, approaches_[k]);
  }
  leave_each_once();
  contact_count_ = sum_over(comm_, Global(contacts_.size()));
}

/// Several pairs may have found the same contact.
void ContactProjection::leave_each_once() {
  std::vector<std::pair<ContactKey, std::size_t>> order;
  for (std::size_t k = 0; k < contacts_.size(); ++k) order.emplace_back(contacts_[k].key, k);
  std::sort(order.begin(), order.end());
  std::vector<Contact> once;
  for (const auto& [key, k] : order)
    if (once.empty() || once.back().key != key) once.push_back(contacts_[k]);
  contacts_ = std::move(once);
}

/// The gap at other positions, as far as the features keep their direction.
double ContactProjection::gap_along(const Pair& pair, const Approach& here,
                                    std::span<const Vec3> field) const {
  Vec3 between = Vec3::Zero();
  for (int i = 0; i < 4; ++i) between += here.weights[i] * field[pair.vertices[i]];
  return here.normal.dot(between) - pair.radius;
}

double ContactProjection::gap_wanted(const Pair& pair, const Approach& here) const {
  const double thickness = thickness_.of(pair, search_.keys());
  if (violation_fraction_kept_ == 0) return thickness;
  return thickness -
         violation_fraction_kept_ * std::max(0.0, thickness - gap_along(pair, here, start_field_));
}

/// Of what is near a round obstacle, faces and edges are contacts. (Vertices alone would be half the rows,
/// but friction then chatters: the capstan's force comes out half as large again.)
void ContactProjection::add_contact(const Pair& pair, const Approach& here) {
  const double gap = gap_along(pair, here, target_field_);
  const bool is_near = std::min(gap, here.gap) < thickness_.near(pair, search_.keys());
  if (!is_near && blocked_.empty()) return;
  const bool inside =
      here.weights[0] != 0 && here.weights[1] != 0 && here.weights[2] != 0 && here.weights[3] != 0;
  const bool is_covered = // vertices against faces have it, or the next triangle of the obstacle
      (pair.kind == PairKind::edge_edge && !inside) ||
      (pair.body >= 0 && !cones_.holds(pair, here, safe_field_, search_.own()));
  if ((!is_near || is_covered) && !blocked_.contains(name_of(pair, search_.keys()))) return;
  double inverse_effective_mass = 0;
  for (int i = 0; i < 4; ++i)
    inverse_effective_mass +=
        here.weights[i] * here.weights[i] * inverse_effective_mass_[pair.vertices[i]][0];
  if (inverse_effective_mass == 0) return; // nothing here can be moved
  contacts_.push_back({pair.vertices, here.weights, here.normal, inverse_effective_mass,
                       gap_wanted(pair, here) - gap, key_of(pair, here, search_.keys()),
                       friction_of(pair, obstacles_, contact_), pair.body});
}

/// Vertices of cloth that are about to press on a sphere though all around them is nearer to it now, and so
/// alone is in the pairs: without a row of their own, what pulls them in goes unopposed. (Along a capsule
/// edges of cloth are in the pairs; with rows of vertices beside theirs the capstan's force came out larger.)
void ContactProjection::add_corners(const Pair& pair, const Approach& here) {
  for (int i = 1; i < 4; ++i) {
    if (here.weights[i] == -1) continue; // the pair is this contact
    Pair corner = pair;
    corner.kind = PairKind::vertex_edge; // an edge of no length
    std::fill(corner.vertices.begin() + 1, corner.vertices.end(), pair.vertices[i]);
    const Approach alone = approach(corner, at(corner, safe_field_));
    const double gap = std::min(alone.gap, gap_along(corner, alone, target_field_));
    if (gap < thickness_.of(pair, search_.keys())) add_contact(corner, alone);
  }
}

/// Fetches what the last step left of contacts that are the first time in this one, and lets them start from
/// it.
void ContactProjection::recall_contacts() {
  std::vector<ContactKey> keys;
  touches_.clear();
  for (const Contact& contact : contacts_) {
    const auto [touch, is_new] = touched_.try_emplace(contact.key);
    touches_.push_back(&touch->second); // stays where it is
    if (is_new) keys.push_back(contact.key);
  }
  for (const auto& [key, entry] : hand_out(cloth_.mesh, at_home_, keys))
    touched_[key] = {entry.carried.scaled(dt_ * dt_), entry.pressed};
}

void ContactProjection::add_normal_row(Local k) {
  const Contact& contact = contacts_[k];
  const ContactRecord& touch = *touches_[k];
  const double so_far = touch.pressed.normal;
  const double before = touch.before ? dt_ * dt_ * touch.before->normal : 0.0;
  const double guess = iteration_ == 1 ? std::max(-so_far, before - so_far) : 0.0;
  rows_.push_back({k, true, contact.normal, contact.violation, -so_far, HUGE_VAL, gap_left * fall_, guess});
}

/// Two tangents of a contact that is pressed: no slip over the step, by no more than Coulomb's force for what
/// pressed it before this iteration. The first is along the force that it would take; the second gets what
/// that leaves of Coulomb's cone, which is nothing where the contact slides.
void ContactProjection::add_friction_rows(Local k) {
  const Contact& contact = contacts_[k];
  const ContactRecord& touch = *touches_[k];
  const ContactImpulse before = touch.before ? touch.before->scaled(dt_ * dt_) : ContactImpulse{};
  double pressing = touch.pressed.normal;
  if (iteration_ == 1) // a new contact is going to be pressed by what it takes to stop it
    pressing =
        touch.before ? before.normal : std::max(0.0, contact.violation) / contact.inverse_effective_mass;
  const double most = contact.friction * pressing;
  if (most <= 0) return;
  Vec3 slip = Vec3::Zero();
  for (int i = 0; i < 4; ++i)
    slip += contact.weights[i] * (target_field_[contact.vertices[i]] - start_field_[contact.vertices[i]]);
  if (contact.body >= 0) slip -= spins_[contact.body] * contact.normal;
  slip -= contact.normal.dot(slip) * contact.normal;
  const Vec3 rubbed = touch.pressed.tangent;
  const Vec3 needed = rubbed - slip / contact.inverse_effective_mass;
  const Vec3 first = needed.norm() * contact.inverse_effective_mass > 1e-12 ? Vec3(needed.normalized())
                                                                            : contact.normal.unitOrthogonal();
  const double rest = std::sqrt(std::max(0.0, most * most - needed.squaredNorm()));
  for (const auto& [tangent, bound] : {std::pair{first, most}, {Vec3(contact.normal.cross(first)), rest}}) {
    const double so_far = tangent.dot(rubbed);
    const double guess = iteration_ == 1 ? tangent.dot(before.tangent) - so_far : 0.0;
    if (bound > 0 || so_far != 0)
      rows_.push_back(
          {k, false, tangent, -tangent.dot(slip), -bound - so_far, bound - so_far, slip_left * fall_, guess});
  }
}

void ContactProjection::note_multipliers() {
  const auto z = qp_.row_part();
  for (std::size_t k = 0; k < rows_.size(); ++k) {
    ContactImpulse& p = touches_[rows_[k].contact]->pressed;
    if (rows_[k].is_normal)
      p.normal = std::max(0.0, p.normal + z[k]);
    else
      p.tangent += z[k] * rows_[k].direction;
  }
}

} // namespace taut
