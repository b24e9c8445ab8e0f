#include "src/contact/augmented_contacts.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace taut {

namespace {

constexpr double stiff = 1;     // see src/newton/README.md
constexpr int most_solves = 10; // to agree on which contacts press and slide

constexpr double spent = 0.1; // of the power of a change, what may be left of it: see `where_spent`
constexpr int most_trials = 20;

/// Where a function that is 1 at 0 comes to nearly zero, or 1 if it is not below that there: by the rule of
/// false position, kept from the ends.
template<class Function>
double where_spent(Function&& f) {
  double low = 0, high = 1, f_low = 1, f_high = f(1);
  if (f_high >= -spent) return 1;
  for (int trial = 0; trial < most_trials; ++trial) {
    const double t = low + (high - low) * std::clamp(f_low / (f_low - f_high), 0.1, 0.9);
    const double value = f(t);
    if (std::abs(value) <= spent) return t;
    (value > 0 ? low : high) = t;
    (value > 0 ? f_low : f_high) = value;
  }
  return high;
}

} // namespace

void AugmentedContacts::begin(std::vector<ForeseenContact> contacts, double dt) {
  dt_ = dt;
  solves_ = 0;
  is_settled_ = false;
  contacts_ = std::move(contacts);
  stiffness_.assign(contacts_.size(), 0.0);
  excess_.assign(contacts_.size(), 1.0);
  kinds_.assign(contacts_.size(), Kind::apart);
  impulses_.clear();
  for (const ForeseenContact& c : contacts_) impulses_.push_back(c.carried);
  held_.clear();
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
  moves_ = between_features(velocities);
  for (Vec3& move : moves_) move *= dt_;
  const std::vector<Kind> before = kinds_;
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    const auto [impulse, kind, excess] = answer(k, moves_[k]);
    impulses_[k] = impulse;
    kinds_[k] = kind;
    excess_[k] = excess;
  }
  const bool has_changed = any_of(scene_.cloth().mesh.comm, kinds_ != before);
  is_settled_ = solves_ >= most_solves || (solves_ > 0 && !has_changed);

  const ContactSearch& search = scene_.search;
  field_.assign(search.size(), Vec3::Zero());
  const auto add = [&](std::size_t k, const Vec3& force) {
    const Contact& contact = contacts_[k].contact;
    for (int i = 0; i < 4; ++i) field_[contact.vertices[i]] += contact.weights[i] * force;
  };
  for (std::size_t k = 0; k < contacts_.size(); ++k) add(k, beyond_carried(k, impulses_[k]));
  for (const auto& [k, direction] : held_) add(k, direction.dot(moves_[k]) * direction);
  search.accumulate(field_);
  for (Local i = 0; i < search.own(); ++i) residual[i] += field_[i];
}

/// How far the features of each contact part in a field of local vertices.
std::vector<Vec3> AugmentedContacts::between_features(std::span<const Vec3> field) {
  const ContactSearch& search = scene_.search;
  field_.assign(search.size(), Vec3::Zero());
  std::copy_n(field.begin(), search.own(), field_.begin());
  search.update(field_);
  std::vector<Vec3> between(contacts_.size(), Vec3::Zero());
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    const Contact& contact = contacts_[k].contact;
    for (int i = 0; i < 4; ++i) between[k] += contact.weights[i] * field_[contact.vertices[i]];
  }
  return between;
}

/// What a contact does whose features part by `move`.
AugmentedContacts::Answer AugmentedContacts::answer(std::size_t k, const Vec3& move) const {
  const auto& [contact, carried, slip, tilts] = contacts_[k];
  const double along = contact.normal.dot(move);
  const double p = carried.normal + stiffness_[k] * (contact.violation - along);
  if (p <= 0) return {};
  const Vec3 t = carried.tangent - stiffness_[k] * (slip + move - along * contact.normal);
  const double most = contact.friction * p, needed = t.norm();
  if (needed <= most) return {{p, t}, Kind::sticks};
  return {{p, t * (most / needed)}, Kind::slides, needed / std::max(most, 1e-3 * needed)};
}

/// In kg m, what the system does not have among its forces.
Vec3 AugmentedContacts::beyond_carried(std::size_t k, const ContactImpulse& now) const {
  const auto& [contact, carried, slip, tilts] = contacts_[k];
  return (now.normal - carried.normal) * contact.normal + now.tangent - carried.tangent;
}

/// Of what contacts do after this part of a change by which their features part: its product with the change.
/// Collective.
double AugmentedContacts::power(std::span<const Vec3> change, double part) const {
  double sum = 0;
  for (std::size_t k = 0; k < contacts_.size(); ++k)
    sum += change[k].dot(beyond_carried(k, answer(k, moves_[k] + part * change[k]).impulse));
  return sum_over(scene_.cloth().mesh.comm, sum);
}

double AugmentedContacts::step_length(std::span<const Vec3> change, double power_of_all) {
  if (power_of_all <= 0) return 1;
  const std::vector<Vec3> parting = between_features(change);
  double held = 0;
  for (const auto& [k, direction] : held_) held += std::pow(direction.dot(parting[k]), 2);
  held = sum_over(scene_.cloth().mesh.comm, held);
  const double others = power_of_all - power(parting, 0);
  return where_spent([&](double part) { // 0 at 1 if no contact changes its kind
    return (others - part * (power_of_all - held) + power(parting, part)) / power_of_all;
  });
}

/// On a round body the point where an element presses wanders as it tilts: a stiffness p0 D against tilting,
/// D the distance to the centre, without which light elements under tension rock on a ball for ever.
void AugmentedContacts::add_rolling(std::vector<Term>& terms) const {
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    const auto& [contact, carried, slip, tilts] = contacts_[k];
    if (kinds_[k] == Kind::apart || carried.normal <= 0) continue;
    for (const auto& tilt : tilts) {
      Term term{contact.vertices, {}};
      for (int i = 0; i < 4; ++i) term.gradient[i] = std::sqrt(carried.normal) * tilt[i] * contact.normal;
      terms.push_back(term);
    }
  }
}

/// The directions in which a contact answers.
void AugmentedContacts::hold(std::size_t k) {
  if (kinds_[k] == Kind::apart) return;
  const Vec3& n = contacts_[k].contact.normal;
  const double root = std::sqrt(stiffness_[k]);
  held_.push_back({k, root * n});
  const Vec3& rubs = impulses_[k].tangent;
  const bool slides = kinds_[k] == Kind::slides;
  if (slides && rubs.isZero()) return;
  const Vec3 first = slides ? Vec3(rubs.normalized()) : n.unitOrthogonal();
  if (!slides) held_.push_back({k, root * first});
  held_.push_back({k, root / std::sqrt(excess_[k]) * n.cross(first)});
}

ContactCouplings AugmentedContacts::couplings() {
  ++solves_;
  held_.clear();
  for (std::size_t k = 0; k < contacts_.size(); ++k) hold(k);
  std::vector<Term> terms;
  for (const auto& [k, direction] : held_) {
    const Contact& contact = contacts_[k].contact;
    Term term{contact.vertices, {}};
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
