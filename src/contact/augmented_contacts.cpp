#include "src/contact/augmented_contacts.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace taut {

namespace {

constexpr double stiff = 10;     // at 100 the linear solver fails, at 1 it rests less
constexpr int enough_solves = 3; // to agree on which contacts press
constexpr int most_solves = 5;   // to agree on which of them slide; then all stay what they are

} // namespace

void AugmentedContacts::begin(std::vector<ForeseenContact> contacts, double dt) {
  dt_ = dt;
  solves_ = 0;
  limits_friction_ = is_settled_ = false;
  contacts_ = std::move(contacts);
  stiffness_.assign(contacts_.size(), 0.0);
  excess_.assign(contacts_.size(), 1.0);
  moves_.resize(contacts_.size());
  kinds_.clear();
  impulses_.clear();
  held_.clear();
  for (const ForeseenContact& c : contacts_) {
    impulses_.push_back(c.carried);
    kinds_.push_back(c.touches ? Kind::sticks : Kind::apart);
  }
  count_ = sum_over(scene_.cloth().mesh.comm, Global(contacts_.size()));
}

void AugmentedContacts::set_metric(std::span<const double> metric) {
  std::vector<double> field(scene_.search.size(), 0.0);
  std::copy_n(metric.begin(), scene_.search.own(), field.begin());
  scene_.search.update(field);
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    const Contact& contact = contacts_[k].contact;
    double yields = 0;
    for (int i = 0; i < 4; ++i)
      yields += contact.weights[i] * contact.weights[i] * field[contact.vertices[i]];
    stiffness_[k] = yields > 0 ? stiff / yields : 0.0;
  }
}

void AugmentedContacts::evaluate(std::span<const Vec3> velocities, std::span<Vec3> residual) {
  find_moves(velocities);
  const std::vector<Kind> before = kinds_;
  const bool is_free = solves_ <= most_solves;
  const MPI_Comm comm = scene_.cloth().mesh.comm;
  if (solves_ > 0 && is_free) {
    choose_pressing();
    limits_friction_ = limits_friction_ || solves_ >= enough_solves || !any_of(comm, kinds_ != before);
  }
  press();
  if (limits_friction_ && is_free) limit_friction();
  is_settled_ = limits_friction_ && (solves_ >= most_solves || !any_of(comm, kinds_ != before));

  const ContactSearch& search = scene_.search;
  field_.assign(search.size(), Vec3::Zero());
  const auto add = [&](std::size_t k, const Vec3& force) {
    const Contact& contact = contacts_[k].contact;
    for (int i = 0; i < 4; ++i) field_[contact.vertices[i]] += contact.weights[i] * force;
  };
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    const auto& [contact, carried, slip, touches, tilts] = contacts_[k];
    add(k, (impulses_[k].normal - carried.normal) * contact.normal + impulses_[k].tangent - carried.tangent);
  }
  for (const auto& [k, direction] : held_) add(k, direction.dot(moves_[k]) * direction);
  search.accumulate(field_);
  for (Local i = 0; i < search.own(); ++i) residual[i] += field_[i];
}

void AugmentedContacts::find_moves(std::span<const Vec3> velocities) {
  const ContactSearch& search = scene_.search;
  field_.assign(search.size(), Vec3::Zero());
  std::copy_n(velocities.begin(), search.own(), field_.begin());
  search.update(field_);
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    const Contact& contact = contacts_[k].contact;
    moves_[k] = Vec3::Zero();
    for (int i = 0; i < 4; ++i) moves_[k] += dt_ * contact.weights[i] * field_[contact.vertices[i]];
  }
}

/// Those that would pull let go, those that have come too near press.
void AugmentedContacts::choose_pressing() {
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    const auto& [contact, carried, slip, touches, tilts] = contacts_[k];
    const double violation = contact.violation - contact.normal.dot(moves_[k]);
    if (kinds_[k] == Kind::apart && violation > 0) kinds_[k] = Kind::sticks;
    if (kinds_[k] != Kind::apart && carried.normal + stiffness_[k] * violation < 0) kinds_[k] = Kind::apart;
  }
}

void AugmentedContacts::press() {
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    const auto& [contact, carried, slip, touches, tilts] = contacts_[k];
    const double along = contact.normal.dot(moves_[k]);
    const Vec3 across = moves_[k] - along * contact.normal;
    impulses_[k].normal =
        kinds_[k] == Kind::apart ? 0.0 : carried.normal + stiffness_[k] * (contact.violation - along);
    if (kinds_[k] == Kind::apart)
      impulses_[k].tangent = Vec3::Zero();
    else if (kinds_[k] == Kind::sticks || solves_ <= most_solves)
      impulses_[k].tangent = carried.tangent - stiffness_[k] * (slip + across);
  }
}

void AugmentedContacts::limit_friction() {
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    if (kinds_[k] == Kind::apart) continue;
    ContactImpulse& now = impulses_[k];
    const double most = contacts_[k].contact.friction * now.normal, needed = now.tangent.norm();
    kinds_[k] = needed > most ? Kind::slides : Kind::sticks;
    if (needed <= most) continue;
    excess_[k] = needed / std::max(most, 1e-3 * needed);
    now.tangent *= most / needed;
  }
}

/// On a round body the point where an element presses wanders as it tilts: a stiffness p0 D against tilting,
/// D the distance to the centre, without which light elements under tension rock on a ball for ever.
void AugmentedContacts::add_rolling(std::vector<Term>& terms) const {
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    const auto& [contact, carried, slip, touches, tilts] = contacts_[k];
    if (kinds_[k] == Kind::apart || carried.normal <= 0) continue;
    for (const auto& tilt : tilts) {
      Term term{contact.vertices, {}};
      for (int i = 0; i < 4; ++i) term.gradient[i] = std::sqrt(carried.normal) * tilt[i] * contact.normal;
      terms.push_back(term);
    }
  }
}

ContactCouplings AugmentedContacts::couplings() {
  ++solves_;
  held_.clear();
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    if (kinds_[k] == Kind::apart) continue;
    const Vec3& n = contacts_[k].contact.normal;
    const double root = std::sqrt(stiffness_[k]);
    held_.push_back({k, root * n});
    const Vec3& rubs = impulses_[k].tangent;
    const bool slides = kinds_[k] == Kind::slides;
    if (slides && rubs.isZero()) continue;
    const Vec3 first = slides ? Vec3(rubs.normalized()) : n.unitOrthogonal();
    if (!slides) held_.push_back({k, root * first});
    held_.push_back({k, root / std::sqrt(slides ? excess_[k] : 1.0) * n.cross(first)});
  }
  std::vector<ContactCouplings::Term> terms;
  for (const auto& [k, direction] : held_) {
    const Contact& contact = contacts_[k].contact;
    ContactCouplings::Term term{contact.vertices, {}};
    for (int i = 0; i < 4; ++i)
      term.gradient[i] =
          scene_.is_cloth(contact.vertices[i]) ? Vec3(contact.weights[i] * direction) : Vec3(Vec3::Zero());
    terms.push_back(term);
  }
  add_rolling(terms);
  const ContactSearch& search = scene_.search;
  return ContactCouplings(search.plan(), search.own(), search.size(), std::move(terms));
}

} // namespace taut
