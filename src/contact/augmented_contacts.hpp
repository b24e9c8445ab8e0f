#pragma once
#include "src/contact/contact_scene.hpp"
#include "src/contact/rows.hpp"
#include "src/linear/contact_couplings.hpp"

namespace taut {

/// For each of two axes, so much per m that the places of a contact move along its normal.
using Tilts = std::array<std::array<double, 4>, 2>;

/// A contact as Newton's method on the whole step meets it, at the start of the step.
struct ForeseenContact {
  Pair pair;              ///< that found it
  Contact contact;        ///< its violation for a cloth that stays where it is
  ContactImpulse carried; ///< kg m, what of its forces has lasted
  Vec3 slip;              ///< m, for a cloth that stays where it is
  /// How an element of cloth rolls on a round body: so much per m that its vertices move along the normal, it
  /// tilts about two axes, in rad times the root of the distance to the body's centre, m. Zero elsewhere.
  Tilts tilts;
};

/// What contacts press and rub at the end of a step, in kg m, as a function of the velocities v with which it
/// ends: the augmented Lagrangian of Alart and Curnier 1991,
///
///     p(v) = max(0, p0 + k violation(v)),   t(v) = t0 - k slip(v), but no longer than friction times p(v),
///
/// from what has lasted, p0 and t0. What k leaves of violation and slip in one step is taken up by what lasts
/// into the next, and so goes away at rest whatever k is. Towards the solver a contact that sticks is three
/// equations, one that slides one and a part of another, one that would pull none.
///
/// Where a contact that lasts presses, and in which direction, follows its features through the step. Taken
/// at the start of the step that is an explicit stiffness, of the force over the distance between features:
/// a fold of cloth on a corner of a body, a thickness away, rocks for ever (src/newton/README.md#contact).
///
/// That is a semi-smooth Newton method. Alone it does not converge where many contacts press at a time, as
/// when a tight garment touches a body: each solve presses on more of them, and harder. With steps that end
/// where their power is spent (`step_length`), it does.
class AugmentedContacts {
public:
  /// `scene` must outlive it.
  explicit AugmentedContacts(const ContactScene& scene) : scene_(scene) {}

  /// For a step over `dt`, in the places that the scene's search has now. Collective.
  void begin(std::vector<ForeseenContact> contacts, double dt);

  /// k of each contact, in parts of what it takes to move its features by the inverse metric W of the system,
  /// 1/kg of local vertices, 0 if held. Collective over neighbours.
  void set_metric(std::span<const double> metric);

  /// What they do at the end velocities of local vertices; adds to `residual`, kg m of own vertices, this and
  /// what the last `couplings` hold back. Collective.
  void evaluate(std::span<const Vec3> velocities, std::span<Vec3> residual);

  /// The derivative of what was evaluated last, to be held in the system from now on. Collective over
  /// neighbours.
  ContactCouplings couplings();

  /// What part of `change`, m of local vertices, to take, at most 1, where `change` solves the system with
  /// the last `couplings`, and `power` is its product with the residual, in kg m^2, of all ranks. That part
  /// at which the residual's product with `change` is near zero, or past which it is: of a convex energy, the
  /// least along the line. Contacts are followed exactly, all else is linear. Collective.
  double step_length(std::span<const Vec3> change, double power);

  /// As evaluated last, of the contacts in their order.
  std::span<const ContactImpulse> impulses() const { return impulses_; }
  /// Whether which contacts press, and which of them slide, was the same when evaluated last as before, and
  /// the change in between was taken whole; or that has been asked for often enough.
  bool is_settled() const { return is_settled_; }
  Global count() const { return count_; } ///< of contacts, over all ranks

private:
  enum class Kind : char { apart, slides, sticks };
  struct Answer {
    ContactImpulse impulse;
    Kind kind = Kind::apart;
    double excess = 1; ///< of friction that slides: what it would take to stick, over what there is
  };
  struct Held { ///< direction direction^T between the features of a contact, where they pressed
    std::size_t contact;
    std::array<double, 4> weights;
    Vec3 direction;
  };
  using Term = ContactCouplings::Term;

  bool is_on_round_body(const Pair& pair) const;
  void follow(std::span<const Vec3> velocities);
  double violation_to_undo(std::size_t contact) const;
  Answer answer(std::size_t contact, const Vec3& move) const;
  Vec3 pressed(std::size_t contact, const ContactImpulse& impulse) const;
  double power(std::span<const Vec3> change, double part) const;
  std::vector<Vec3> between_features(std::span<const Vec3> field);
  void hold(std::size_t contact);
  void add_rolling(std::vector<Term>& terms) const;

  const ContactScene& scene_;
  double dt_ = 0;
  Global count_ = 0;
  int solves_ = 0; ///< of the system in this step
  bool is_settled_ = false;
  double part_taken_ = 1; ///< of the last change
  std::vector<ForeseenContact> contacts_;
  // of contacts
  std::vector<double> wanted_;    ///< m from the second feature to the first, along the normal
  std::vector<double> stiffness_; ///< kg, against slip
  std::vector<double> hardness_;  ///< kg, against violation
  std::vector<Kind> kinds_;
  std::vector<double> excess_;
  std::vector<ContactImpulse> impulses_;
  std::vector<Vec3> moves_; ///< m that their features part over the step
  std::vector<Held> held_;  ///< in the system
  std::vector<Vec3> field_, forces_;
};

} // namespace taut
