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

/// What the step before pressed, for the present step size.
Pressed ContactProjection::before(const ContactKey& key) const {
  const auto found = pressed_before_.find(key);
  return found == pressed_before_.end() ? Pressed{} : found->second.scaled(dt_ * dt_);
}

/// Of the contacts with rows: what has pressed them so far, and what of it lasts (per dt^2, newtons); both
/// also as forces on vertices.
void ContactProjection::note_contact_forces(Candidate& candidate) {
  noted_.clear();
  candidate.contact_force.assign(candidate.contact_force.size(), Vec3::Zero());
  candidate.pressing.assign(candidate.pressing.size(), Vec3::Zero());
  if (contacts_ == 0) return;
  std::vector<Vec3> lasting_forces(search_.size(), Vec3::Zero()), all_forces = lasting_forces;
  for (const ContactRow& row : rows_) {
    if (!row.is_normal) continue;
    const Pressed now = pressed_[row.key].scaled(1 / (dt_ * dt_));
    if (now.normal <= 0) continue;
    const auto found = pressed_before_.find(row.key);
    const Pressed carried = found == pressed_before_.end() ? Pressed{} : lasting(found->second, now);
    noted_[row.key] = {now, carried};
    for (int i = 0; i < 4; ++i) {
      lasting_forces[row.vertices[i]] += row.weights[i] * (carried.normal * row.direction + carried.tangent);
      all_forces[row.vertices[i]] += row.weights[i] * (now.normal * row.direction + now.tangent);
    }
  }
  search_.accumulate(lasting_forces);
  search_.accumulate(all_forces);
  std::copy_n(lasting_forces.begin(), search_.own(), candidate.contact_force.begin());
  std::copy_n(all_forces.begin(), search_.own(), candidate.pressing.begin());
  cloth_.mesh.vertex_halo.update(candidate.contact_force);
}

/// Fetches what the last step left of contacts that have their first row in this one, and lets all start from
/// it.
void ContactProjection::recall_contacts() {
  std::vector<ContactKey> keys;
  for (const ContactRow& row : rows_)
    if (!pressed_.contains(row.key)) keys.push_back(row.key);
  for (const auto& [key, entry] : hand_out(cloth_.mesh, at_home_, keys)) {
    pressed_before_[key] = entry.pressed;
    pressed_[key] = entry.carried.scaled(dt_ * dt_);
  }
  for (ContactRow& row : rows_) {
    const double so_far = pressed_[row.key].normal;
    row.lower = -so_far;
    if (iteration_ == 1) row.guess = std::max(-so_far, before(row.key).normal - so_far);
  }
}

void ContactProjection::make_rows() {
  rows_.clear();
  search_.gather(target_.cloth, target_.obstacles, target_field_);
  for (std::size_t k = 0; k < search_.pairs().size(); ++k) add_normal_row(search_.pairs()[k], approaches_[k]);
  // several pairs may have found the same contact
  std::sort(rows_.begin(), rows_.end(), [](const auto& a, const auto& b) { return a.key < b.key; });
  rows_.erase(
      std::unique(rows_.begin(), rows_.end(), [](const auto& a, const auto& b) { return a.key == b.key; }),
      rows_.end());
  const std::size_t normals = rows_.size();
  contacts_ = sum_over(comm_, Global(normals));
  if (contacts_ > 0) recall_contacts();
  for (std::size_t k = 0; k < normals; ++k) add_friction_rows(ContactRow(rows_[k]));
}

/// Of what is near a round obstacle, faces and edges have rows. (Vertices alone would be half the rows, but
/// friction then chatters: the capstan's force comes out half as large again.)
void ContactProjection::add_normal_row(const Pair& pair, const Approach& here) {
  Vec3 ahead = Vec3::Zero();
  for (int i = 0; i < 4; ++i) ahead += here.weights[i] * target_field_[pair.vertices[i]];
  const double gap = here.normal.dot(ahead) - pair.radius;
  const bool blocked = !blocked_.empty() && blocked_.contains(name_of(pair, search_.keys()));
  const double thickness = thickness_.of(pair, search_.keys());
  if (std::min(gap, here.gap) >= 2.0 * thickness && !blocked) return;
  const bool inside =
      here.weights[0] != 0 && here.weights[1] != 0 && here.weights[2] != 0 && here.weights[3] != 0;
  if (pair.kind == PairKind::edge_edge && !inside && !blocked) return; // vertices against faces have it
  double mobility = 0;
  for (int i = 0; i < 4; ++i) mobility += here.weights[i] * here.weights[i] * mobility_[pair.vertices[i]][0];
  if (mobility == 0) return; // nothing here can be moved
  const ContactKey key = key_of(pair, here, search_.keys());
  rows_.push_back({pair.vertices, here.weights, here.normal, mobility, thickness - gap, 0.0, HUGE_VAL,
                   gap_left * fall_, 0.0, key, true});
  rows_.back().body = pair.body;
  rows_.back().friction = friction_of(pair, obstacles_, contact_);
}

/// The force that pressed a contact before this iteration, position-level.
double ContactProjection::pressing(const ContactRow& normal) const {
  if (iteration_ > 1) {
    const auto now = pressed_.find(normal.key);
    return now == pressed_.end() ? 0.0 : now->second.normal;
  }
  // a new contact is going to be pressed by what it takes to stop it
  return pressed_before_.contains(normal.key) ? before(normal.key).normal
                                              : std::max(0.0, normal.missing) / normal.mobility;
}

/// Two tangents of a contact that is pressed: no slip over the step, by no more than Coulomb's force. The
/// first is along the force that it would take; the second gets what that leaves of Coulomb's cone, which is
/// nothing where the contact slides.
void ContactProjection::add_friction_rows(const ContactRow& normal) {
  const double most = normal.friction * pressing(normal);
  if (most <= 0) return;
  Vec3 slip = Vec3::Zero();
  for (int i = 0; i < 4; ++i)
    slip += normal.weights[i] * (target_field_[normal.vertices[i]] - start_field_[normal.vertices[i]]);
  if (normal.body >= 0) slip -= spins_[normal.body] * normal.direction;
  slip -= normal.direction.dot(slip) * normal.direction;
  const auto now = pressed_.find(normal.key);
  const Vec3 rubbed = now == pressed_.end() ? Vec3(Vec3::Zero()) : now->second.tangent;
  const Vec3 needed = rubbed - slip / normal.mobility;
  const Vec3 first =
      needed.norm() * normal.mobility > 1e-12 ? Vec3(needed.normalized()) : normal.direction.unitOrthogonal();
  const double rest = std::sqrt(std::max(0.0, most * most - needed.squaredNorm()));
  for (const auto& [tangent, bound] : {std::pair{first, most}, {Vec3(normal.direction.cross(first)), rest}}) {
    const double so_far = tangent.dot(rubbed);
    const double guess = iteration_ == 1 ? tangent.dot(before(normal.key).tangent) - so_far : 0.0;
    if (bound > 0 || so_far != 0)
      rows_.push_back({normal.vertices, normal.weights, tangent, normal.mobility, -tangent.dot(slip),
                       -bound - so_far, bound - so_far, slip_left * fall_, guess, normal.key, false});
  }
}

void ContactProjection::note_multipliers() {
  const auto z = qp_.row_part();
  for (std::size_t k = 0; k < rows_.size(); ++k) {
    Pressed& p = pressed_[rows_[k].key];
    if (rows_[k].is_normal)
      p.normal = std::max(0.0, p.normal + z[k]);
    else
      p.tangent += z[k] * rows_[k].direction;
  }
}

} // namespace taut
