#include "src/contact/contact_rows.hpp"

#include "src/contact/friction.hpp"

#include <Eigen/Geometry>
#include <boost/container/static_vector.hpp>

#include <algorithm>
#include <array>
#include <cmath>

// Friction of ContactRows.
namespace taut {

namespace {

constexpr double slip_left = 0.03; ///< by a program, of what a free vertex falls in a step

/// The sides, from the middle, of a box in a circle of this radius: as nearly a square as holds the place, or
/// what the circle has nearest to it.
std::array<double, 2> box_in_circle(double radius, std::array<double, 2> place) {
  const double length = std::hypot(place[0], place[1]);
  if (length > radius) place = {place[0] * (radius / length), place[1] * (radius / length)};
  const int longer = place[1] > place[0] ? 1 : 0;
  std::array<double, 2> sides;
  sides[longer] = std::max(place[longer], std::sqrt(0.5) * radius);
  sides[1 - longer] = std::sqrt(std::max(0.0, radius * radius - sides[longer] * sides[longer]));
  return sides;
}

} // namespace

/// m by which the features slip over the step, without what changes their gap; as a body sees it that turns,
/// so that nothing slips that turns with it.
Vec3 ContactRows::slip_of(const Contact& contact) const {
  const auto from = scene_.start_field(), to = scene_.target_field();
  Vec3 before = Vec3::Zero(), slip = before; // from the one to the other
  for (int i = 0; i < 4; ++i) {
    before += contact.weights[i] * from[contact.vertices[i]];
    slip += contact.weights[i] * (to[contact.vertices[i]] - from[contact.vertices[i]]);
  }
  slip -= scene_.spin(contact.body, before);
  return slip - contact.normal.dot(slip) * contact.normal;
}

/// The same and what is left of drift, which a step that is short all of a sudden leaves as it is.
Vec3 ContactRows::to_undo(Local k) const {
  const Contact& contact = contacts_[k];
  const Vec3& drift = records_[k]->drift;
  return slip_of(contact) + (1 - overlap_kept_) * (drift - contact.normal.dot(drift) * contact.normal);
}

/// Contacts that slide draw the place where they would stick behind them.
void ContactRows::note_drift() {
  if (count_ == 0) return;
  scene_.gather_target();
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    const Contact& contact = contacts_[k];
    Vec3 drift = records_[k]->drift + slip_of(contact);
    drift -= contact.normal.dot(drift) * contact.normal;
    const double length = drift.norm();
    if (length > anchor_reach_) drift *= anchor_reach_ / length;
    records_[k]->drifted = scene_.turned(contact.body, drift);
  }
}

/// Two tangents of a contact that is pressed: no slip over the step, by no more than Coulomb's force for what
/// pressed it before this iteration. The first is along the force that it would take; the second gets what
/// that leaves of Coulomb's cone, which is nothing where the contact slides.
void ContactRows::add_friction_rows(Local k, int iteration) {
  const Contact& contact = contacts_[k];
  const ContactRecord& record = *records_[k];
  const ContactImpulse before = record.before ? record.before->scaled(dt_ * dt_) : ContactImpulse{};
  double normal_impulse = record.impulse.normal;
  if (iteration == 1) // a new contact is going to be pressed by what it takes to stop it
    normal_impulse =
        record.before ? before.normal : std::max(0.0, contact.violation) / contact.inverse_effective_mass;
  const double most = contact.friction * normal_impulse;
  if (most <= 0 && record.impulse.tangent.isZero(0)) return;
  const Vec3 slip = to_undo(k);
  const Vec3 rubbed = record.impulse.tangent;
  const Vec3 needed = rubbed - slip / contact.inverse_effective_mass;
  const Vec3 first = needed.norm() * contact.inverse_effective_mass > 1e-12 ? Vec3(needed.normalized())
                                                                            : contact.normal.unitOrthogonal();
  const double rest = std::sqrt(std::max(0.0, most * most - needed.squaredNorm()));
  for (const auto& [tangent, bound] : {std::pair{first, most}, {Vec3(contact.normal.cross(first)), rest}}) {
    const double so_far = tangent.dot(rubbed);
    const double guess = iteration == 1 ? tangent.dot(before.tangent) - so_far : 0.0;
    if (bound > 0 || so_far != 0)
      rows_.push_back(
          {k, false, tangent, -tangent.dot(slip), -bound - so_far, bound - so_far, slip_left * fall_, guess});
  }
}

/// The second tangent gets what the first leaves of the cone.
void ContactRows::limit_friction(std::span<const double> z, std::span<double> lower,
                                 std::span<double> upper) const {
  double most = 0, left = 0; // kg m: of the contact, and for the next row
  for (std::size_t row = 0; row < rows_.size(); ++row) {
    const Local k = rows_[row].contact;
    const ContactImpulse& before = records_[k]->impulse;
    if (rows_[row].is_normal) {
      left = most = contacts_[k].friction * std::max(0.0, before.normal + z[row]);
      continue;
    }
    const double so_far = rows_[row].direction.dot(before.tangent);
    lower[row] = -left - so_far;
    upper[row] = left - so_far;
    const double rubs = std::min(left, std::abs(so_far + z[row]));
    left = std::sqrt(most * most - rubs * rubs);
  }
}

/// What presses a contact that may rub only grows.
void ContactRows::stay_in_cones(std::span<const double> z, std::span<double> lower,
                                std::span<double> upper) const {
  for (std::size_t first = 0, last = 0; first < rows_.size(); first = last) {
    const Local k = rows_[first].contact;
    const ContactImpulse& before = records_[k]->impulse;
    std::array<double, 2> so_far{}, rubs{}; // along the tangents
    for (last = first + 1; last < rows_.size() && rows_[last].contact == k; ++last) {
      const std::size_t i = last - first - 1;
      so_far[i] = rows_[last].direction.dot(before.tangent);
      rubs[i] = std::abs(so_far[i] + z[last]);
    }
    if (last == first + 1) continue;
    lower[first] = std::max(lower[first], z[first]);
    const auto bound = box_in_circle(contacts_[k].friction * std::max(0.0, before.normal + z[first]), rubs);
    for (std::size_t row = first + 1; row < last; ++row) {
      const std::size_t i = row - first - 1;
      lower[row] = -bound[i] - so_far[i];
      upper[row] = bound[i] - so_far[i];
    }
  }
}

/// Rows of one contact stand together, the normal one first.
void ContactRows::keep_in_cones(std::span<double> z) const {
  for (std::size_t first = 0, last = 0; first < rows_.size(); first = last) {
    const Local k = rows_[first].contact;
    const ContactImpulse& before = records_[k]->impulse;
    Vec3 tangent = before.tangent;
    for (last = first + 1; last < rows_.size() && rows_[last].contact == k; ++last)
      tangent += z[last] * rows_[last].direction;
    const double most = contacts_[k].friction * std::max(0.0, before.normal + z[first]),
                 length = tangent.norm();
    if (length <= most) continue;
    const Vec3 kept = (most / length) * tangent - before.tangent;
    for (std::size_t row = first + 1; row < last; ++row) z[row] = rows_[row].direction.dot(kept);
  }
}

} // namespace taut
