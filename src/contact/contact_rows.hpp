#pragma once
#include "src/config/case.hpp"
#include "src/contact/augmented_contacts.hpp"
#include "src/contact/normal_cones.hpp"
#include "src/contact/safe_iterate.hpp"

#include <algorithm>
#include <unordered_map>

namespace taut {

/// The contacts of a step and their rows in a quadratic program: a normal one that asks for the thickness,
/// and for a contact that is pressed two of friction. Friction is Coulomb's, implicit: a row for each of two
/// tangents asks for no slip over the step, with a multiplier of at most the coefficient times the normal
/// one: first that of the iteration before (in the first iteration, of the step before), then that which the
/// program finds (limit_friction), at last such that it stays within Coulomb's cone (stay_in_cones). What
/// programs leave beyond that is cut off (keep_in_cones), so that the law holds for every contact of every
/// step.
///
/// Nothing is remembered here from step to step: what the last one pressed and carried is part of the state
/// (`Multipliers::contacts`), in newtons, because the next step may be of another size. When a rank makes the
/// first row of a contact in a step, it fetches the contact's entry from its home; at the end of the step
/// each rank sends home what its rows pressed. So the memory depends neither on the partition nor on who
/// found a contact before; two ranks that find the same one share its entry, and what has no row at the end
/// of a step is forgotten.
class ContactRows {
public:
  /// All must outlive them; `gravity` in m/s^2, `longest_step` in s.
  ContactRows(ContactScene& scene, const SafeIterate& safe, const Thickness& thickness,
              const config::Contact& options, double gravity, double longest_step);

  /// For a step over `dt` from where the last one left `memory`; this part of the overlap that it starts with
  /// may stay. Not collective.
  void begin(const ContactMemory& memory, double dt, double overlap_kept);

  /// The contacts at the start of the step, where safe iterate and target must be, before its end is known.
  /// Collective.
  std::vector<ForeseenContact> foresee();

  /// What the contacts foreseen last have pressed and rubbed, in kg m: rows go on from there, as if the last
  /// step had done it. Not collective.
  void take(std::span<const ContactImpulse> impulses);

  /// The search has other pairs than when contacts were looked for last, but the first `known` are the same.
  /// Not collective.
  void keep_pairs(std::size_t known) { seen_.resize(std::min(known, seen_.size())); }

  /// Those of the pairs that are near at the safe iterate or at the target, in iteration `iteration` of the
  /// step, from 1. Collective.
  void make(int iteration);

  /// Whether no contact is nearer than a program may leave it. Collective.
  bool are_met() const;

  /// Bounds of the increments of friction by the normal forces that the increments `z` make. Not collective.
  void limit_friction(std::span<const double> z, std::span<double> lower, std::span<double> upper) const;

  /// Bounds from what increments `z` make of forces, with which friction stays in Coulomb's cones however the
  /// program ends. Not collective.
  void stay_in_cones(std::span<const double> z, std::span<double> lower, std::span<double> upper) const;

  /// Shortens what increments `z` of the rows' multipliers make of friction to what Coulomb allows for what
  /// they make of normal forces. Not collective.
  void keep_in_cones(std::span<double> z) const;

  /// Adds the increments `z` of the rows' multipliers to what the contacts press and rub. Not collective.
  void add(std::span<const double> z);

  /// How far contacts are from where they stick, at a target that programs have moved. Collective over
  /// neighbours.
  void note_drift();

  /// What the contacts there are press and carry, as forces on vertices. Collective over neighbours.
  void report_forces(Candidate& candidate) const;

  /// For the next step, at their homes. Collective.
  ContactMemory memory() const;

  Global count() const { return count_; } ///< of contacts, over all ranks
  std::span<const Contact> contacts() const { return contacts_; }
  std::span<const ContactRow> rows() const { return rows_; }

private:
  /// What presses and rubs between two features.
  struct ContactRecord {
    ContactImpulse impulse;               ///< kg m, by the step's programs and what is carried
    std::optional<ContactImpulse> before; ///< N, by the last step
    Vec3 drift = Vec3::Zero();            ///< m, at the start of the step
    Vec3 drifted = Vec3::Zero();          ///< m, at the target
    int round = 0;                        ///< that found it last

    bool has_pressed() const { return impulse.normal > 0 || before; }
  };
  using Known = std::unordered_map<ContactKey, ContactRecord, HashOfKey>;
  /// The contact that a pair was when it was looked at last, by which of its features were in play.
  struct Seen {
    unsigned features = 0; ///< a bit for each of its vertices with a weight
    Known::value_type* contact = nullptr;
  };
  /// A pair as it is at the safe iterate.
  struct Sight {
    const Pair& pair;
    const Approach& here;
    bool has_stopped = false; ///< the safe iterate
  };

  double fall(double seconds) const;
  void find_contacts();
  double gap_along(const Pair& pair, const Approach& here, std::span<const Vec3> field) const;
  double gap_wanted(const Pair& pair, const Approach& here) const;
  void add_contact(const Sight& sight, Seen& seen);
  Known::value_type& known_as(const Pair& pair, const Approach& here, Seen& seen);
  void add_corners(const Pair& pair, const Approach& here);
  void recall();
  void drop_idle();
  void turn_impulse(Local contact);
  void add_normal_row(Local contact, int iteration);
  void add_friction_rows(Local contact, int iteration);
  Tilts tilts_of(const Contact& contact) const;
  Vec3 slip_of(const Contact& contact) const;
  Vec3 to_undo(Local contact) const;
  ContactEntry entry_of(const ContactRecord& record) const;

  ContactScene& scene_;
  const SafeIterate& safe_;
  const Thickness& thickness_;
  const config::Contact& options_;
  NormalCones cones_;
  double gravity_;
  double anchor_reach_; ///< m that drift is at most
  // of the step in hand
  double dt_ = 0, overlap_kept_ = 0;
  double fall_ = 0;         ///< m that gravity moves a free vertex, at most the smallest thickness
  double aslant_ = 0;       ///< sine by which directions may be outside of normal cones
  double corner_reach_ = 0; ///< m beyond the thickness to which corners are contacts: see add_corners
  Global count_ = 0;
  std::vector<Contact> contacts_;
  std::vector<ContactRecord*> records_; ///< of the contacts, into `known_`
  std::vector<Pair> found_by_;          ///< of the contacts, until idle ones are dropped
  std::vector<ContactKey> unknown_;     ///< of the contacts: those that are there the first time in this step
  int round_ = 0;                       ///< of looking for contacts
  std::vector<ContactRow> rows_;
  ContactMemory at_home_;  ///< of the last step, what no rank has asked for yet
  Known known_;            ///< in this step
  std::vector<Seen> seen_; ///< of pairs that still have the places they had
};

} // namespace taut
