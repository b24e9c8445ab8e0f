#include "src/contact/augmented_contacts.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace taut {

namespace {

// Parts of what moves the features of a contact, see src/newton/README.md
constexpr double stiff = 1;            // against slip, and on what is round or cloth
constexpr double stiff_on_facets = 30; // against violation
constexpr double undone_if_hard = 0.5; // in a step, of a violation

constexpr double turned = 0.7;  // cosine of what the direction of a contact turns by at most in a change
constexpr int most_solves = 10; // to agree on which contacts press and slide

constexpr double spent = 0.1; // of the power of a change, what may be left of it: see `where_spent`
constexpr int most_trials = 20;
constexpr double whole = 0.9; // part of a change that leaves no more than that

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
  hardness_ = stiffness_;
  excess_.assign(contacts_.size(), 1.0);
  kinds_.assign(contacts_.size(), Kind::apart);
  impulses_.clear();
  wanted_.clear();
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    const Contact& contact = contacts_[k].contact;
    impulses_.push_back(contacts_[k].carried);
    const Vec3 apart = between(contact.vertices, contact.weights, scene_.target_field());
    wanted_.push_back(contact.violation + contact.normal.dot(apart));
  }
  held_.clear();
  count_ = sum_over(scene_.cloth().mesh.comm, Global(contacts_.size()));
}

void AugmentedContacts::set_metric(std::span<const double> metric) {
  std::vector<double> field(scene_.search.size(), 0.0);
  std::copy_n(metric.begin(), scene_.search.own(), field.begin());
  scene_.search.update(field);
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    const auto& [pair, contact, carried, slip, tilts] = contacts_[k];
    double yields = 0;
    for (int i = 0; i < 4; ++i)
      yields += contact.weights[i] * contact.weights[i] * field[contact.vertices[i]];
    if (yields == 0) continue;
    const bool is_on_facets =
        pair.body >= 0 && pair.kind != PairKind::vertex_plane && !is_on_round_body(pair);
    stiffness_[k] = stiff / yields;
    hardness_[k] = (is_on_facets ? stiff_on_facets : stiff) / yields;
  }
}

void AugmentedContacts::evaluate(std::span<const Vec3> velocities, std::span<Vec3> residual) {
  follow(velocities);
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
  is_settled_ = solves_ >= most_solves || (solves_ > 0 && !has_changed && part_taken_ > whole);

  const ContactSearch& search = scene_.search;
  forces_.assign(search.size(), Vec3::Zero());
  const auto add = [&](std::size_t k, const std::array<double, 4>& weights, const Vec3& force) {
    for (int i = 0; i < 4; ++i) forces_[contacts_[k].contact.vertices[i]] += weights[i] * force;
  };
  for (std::size_t k = 0; k < contacts_.size(); ++k)
    add(k, contacts_[k].contact.weights, pressed(k, impulses_[k]));
  for (const auto& [k, weights, direction] : held_)
    add(k, weights, dt_ * direction.dot(between(contacts_[k].contact.vertices, weights, field_)) * direction);
  search.accumulate(forces_);
  for (Local i = 0; i < search.own(); ++i) residual[i] += forces_[i];
}

bool AugmentedContacts::is_on_round_body(const Pair& pair) const {
  return pair.body >= 0 && scene_.obstacles().body(pair.body).is_round;
}

/// Where contacts that last press once the cloth has moved; those on round bodies have `tilts` instead. What
/// turns round has been passed through, which is not for the solves to undo. (Those that press the first time
/// follow their features too: at an impact directions then turn from solve to solve, and cases/moving-body
/// rejects 13 steps of 148.)
void AugmentedContacts::follow(std::span<const Vec3> velocities) {
  Scene moved{scene_.start().cloth, scene_.target.obstacles};
  for (std::size_t i = 0; i < moved.cloth.size(); ++i) moved.cloth[i] += dt_ * velocities[i];
  scene_.gather(moved, field_);
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    auto& [pair, contact, carried, slip, tilts] = contacts_[k];
    if (carried.normal <= 0 || is_on_round_body(pair)) continue;
    const Approach now = approach(pair, at(pair, field_));
    if (now.normal.dot(contact.normal) < turned) continue;
    contact.weights = now.weights;
    contact.normal = now.normal;
    const Vec3 apart = between(contact.vertices, now.weights, scene_.target_field());
    contact.violation = wanted_[k] - now.normal.dot(apart);
  }
}

/// How far the features of each contact part in a field of local vertices, which is in `field_` then.
std::vector<Vec3> AugmentedContacts::between_features(std::span<const Vec3> field) {
  const ContactSearch& search = scene_.search;
  field_.assign(search.size(), Vec3::Zero());
  std::copy_n(field.begin(), search.own(), field_.begin());
  search.update(field_);
  std::vector<Vec3> parting;
  for (const ForeseenContact& c : contacts_)
    parting.push_back(between(c.contact.vertices, c.contact.weights, field_));
  return parting;
}

/// m, of a cloth that stays where it is. What is hard has left little, and undoing it at once would throw the
/// cloth off.
double AugmentedContacts::violation_to_undo(std::size_t k) const {
  const double violation = contacts_[k].contact.violation;
  return violation > 0 && hardness_[k] > stiffness_[k] ? undone_if_hard * violation : violation;
}

/// What a contact does whose features part by `move`.
AugmentedContacts::Answer AugmentedContacts::answer(std::size_t k, const Vec3& move) const {
  const auto& [pair, contact, carried, slip, tilts] = contacts_[k];
  const double along = contact.normal.dot(move);
  const double p = carried.normal + hardness_[k] * (violation_to_undo(k) - along);
  if (p <= 0) return {};
  const Vec3 t = carried.tangent - stiffness_[k] * (slip + move - along * contact.normal);
  const double most = contact.friction * p, needed = t.norm();
  if (needed <= most) return {{p, t}, Kind::sticks};
  return {{p, t * (most / needed)}, Kind::slides, needed / std::max(most, 1e-3 * needed)};
}

/// kg m, on the first feature of a contact.
Vec3 AugmentedContacts::pressed(std::size_t k, const ContactImpulse& impulse) const {
  return impulse.normal * contacts_[k].contact.normal + impulse.tangent;
}

/// Of what contacts do after this part of a change by which their features part: its product with the change.
/// Collective.
double AugmentedContacts::power(std::span<const Vec3> change, double part) const {
  double sum = 0;
  for (std::size_t k = 0; k < contacts_.size(); ++k)
    sum += change[k].dot(pressed(k, answer(k, moves_[k] + part * change[k]).impulse));
  return sum_over(scene_.cloth().mesh.comm, sum);
}

double AugmentedContacts::step_length(std::span<const Vec3> change, double power_of_all) {
  part_taken_ = 1;
  if (power_of_all <= 0) return 1;
  const std::vector<Vec3> parting = between_features(change);
  double held = 0;
  for (const auto& [k, weights, direction] : held_)
    held += std::pow(direction.dot(between(contacts_[k].contact.vertices, weights, field_)), 2);
  held = sum_over(scene_.cloth().mesh.comm, held);
  const double others = power_of_all - power(parting, 0);
  part_taken_ = where_spent([&](double part) { // 0 at 1 if no contact changes its kind
    return (others - part * (power_of_all - held) + power(parting, part)) / power_of_all;
  });
  return part_taken_;
}

/// On a round body the point where an element presses wanders as it tilts: a stiffness p0 D against tilting,
/// D the distance to the centre, without which light elements under tension rock on a ball for ever.
void AugmentedContacts::add_rolling(std::vector<Term>& terms) const {
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    const auto& [pair, contact, carried, slip, tilts] = contacts_[k];
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
  const auto& weights = contacts_[k].contact.weights;
  const Vec3& n = contacts_[k].contact.normal;
  const double root = std::sqrt(stiffness_[k]);
  held_.push_back({k, weights, std::sqrt(hardness_[k]) * n});
  const Vec3& rubs = impulses_[k].tangent;
  const bool slides = kinds_[k] == Kind::slides;
  if (slides && rubs.isZero()) return;
  const Vec3 first = slides ? Vec3(rubs.normalized()) : n.unitOrthogonal();
  if (!slides) held_.push_back({k, weights, root * first});
  held_.push_back({k, weights, root / std::sqrt(excess_[k]) * n.cross(first)});
}

ContactCouplings AugmentedContacts::couplings() {
  ++solves_;
  held_.clear();
  for (std::size_t k = 0; k < contacts_.size(); ++k) hold(k);
  std::vector<Term> terms;
  for (const auto& [k, weights, direction] : held_) {
    const Contact& contact = contacts_[k].contact;
    Term term{contact.vertices, {}};
    for (int i = 0; i < 4; ++i)
      term.gradient[i] =
          scene_.is_cloth(contact.vertices[i]) ? Vec3(weights[i] * direction) : Vec3(Vec3::Zero());
    terms.push_back(term);
  }
  add_rolling(terms);
  const ContactSearch& search = scene_.search;
  return ContactCouplings(search.plan(), search.own(), search.size(), std::move(terms));
}

} // namespace taut
