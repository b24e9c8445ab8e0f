#pragma once
#include "src/contact/normal_cones.hpp"
#include "src/contact/thickness.hpp"
#include "src/filters/contact_qp.hpp"
#include "src/filters/velocity_filter.hpp"
#include "src/linear/projection_system.hpp"

#include <optional>
#include <set>
#include <unordered_map>

namespace taut {

/// Fast Projection with contact inside it: from the candidate end positions y, edges as equations and
/// contacts as inequalities in one quadratic program, around an iterate x that never intersects.
///
///     minimise 1/2 |dy|_M^2  subject to  C(y) + J dy = 0,  n . sum_i w_i (y + dy)_i >= thickness
///
/// is solved for its multipliers (ContactQp). Then x moves towards y by the largest fraction of the way on
/// which, by conservative advancement, no pair of features comes too near; pairs that stopped it get a row in
/// the next iteration whatever their distance. The step is good when x has arrived and the measured strain is
/// within the limit.
///
/// Friction is Coulomb's, implicit: a row for each of two tangents asks for no slip over the step, with a
/// multiplier of at most the coefficient times the normal one of the iteration before (in the first
/// iteration, of the step before).
///
/// The filter remembers nothing from step to step: what the last one pressed, carried and pulled is part of
/// the state (`State::contacts`, `State::pulled`), in newtons, because the next step may be of another size.
/// When a rank makes the first row of a contact in a step, it fetches the contact's entry from its home; at
/// the end of the step each rank sends home what its rows pressed. So the memory depends neither on the
/// partition nor on who found a contact before; two ranks that find the same one share its entry, and what
/// has no row at the end of a step is forgotten.
///
/// Without a contact in reach it is Fast Projection, to the last digit unless steps are so short that the
/// bound on the edges' compliance tells.
class ContactProjection : public VelocityFilter {
public:
  /// `cloth` and `obstacles` must outlive the filter; `weight` is that of the whole cloth in N. Throws
  /// InputError for a thickness that the mesh cannot have. Collective.
  ContactProjection(const Cloth& cloth, const Obstacles& obstacles, const Case& input, double weight);

  FilterReport apply(const State& start, double dt, const Freedom& freedom, Candidate& candidate) override;

private:
  /// What presses and rubs between two features.
  struct ContactRecord {
    ContactImpulse pressed;               ///< kg m, by the step's programs and what is carried
    std::optional<ContactImpulse> before; ///< N, by the last step
  };

  /// Cloth (local vertices) and obstacles.
  struct Scene {
    std::vector<Vec3> cloth, obstacles;
  };

  void begin(const State& start, double dt, const Freedom& freedom, const Candidate& candidate);
  Motion motion() const { return {safe_.cloth, target_.cloth, safe_.obstacles, target_.obstacles}; }
  void update_pairs(std::size_t known);
  void measure_gaps(std::size_t known);
  double strain_at_target(const Freedom& freedom);
  double stretch_to_leave(Local edge) const;
  ContactEntry entry_of(const ContactRecord& touch) const;
  void note_contact_forces(Candidate& candidate);
  ContactMemory pressed_contacts() const;
  void make_rows();
  void recall_contacts();
  void find_contacts();
  void leave_each_once();
  double gap_along(const Pair& pair, const Approach& here, std::span<const Vec3> field) const;
  double gap_wanted(const Pair& pair, const Approach& here) const;
  void add_contact(const Pair& pair, const Approach& here);
  void add_corners(const Pair& pair, const Approach& here);
  void add_normal_row(Local contact);
  void add_friction_rows(Local contact);
  void project(double strain, FilterReport& report);
  void note_multipliers();
  double distance_behind() const;
  double step_length();
  void advance_safe(double alpha);
  void free_stuck();
  void propose(Candidate& candidate) const;
  std::string what_stopped() const;

  MPI_Comm comm_;
  const Cloth& cloth_;
  config::Inextensibility limits_;
  config::Contact contact_;
  const Obstacles& obstacles_;
  ContactSearch search_;
  ProjectionSystem system_;
  ContactQp qp_;
  Thickness thickness_;
  NormalCones cones_;
  double compliance_, gravity_, settling_time_;

  // of the step in hand
  double dt_ = 0;
  const Freedom* freedom_ = nullptr;
  double violation_fraction_kept_ =
      0;            ///< part of the strain and overlap that the last step left which this one may leave
  double fall_ = 0; ///< m that gravity moves a free vertex, at most the smallest thickness
  int iteration_ = 0;
  Global contact_count_ = 0; ///< over all ranks
  Scene start_, safe_, target_;
  std::vector<Mat3> spins_; ///< m, of the obstacles over the step
  std::vector<Vec3> start_field_, safe_field_, target_field_;
  std::vector<Vec3> inverse_effective_mass_; ///< 1/kg, in the first component, as a contact field
  std::vector<Approach> approaches_;         ///< of the pairs, at `safe_`
  std::set<ContactKey> blocked_;             ///< pairs that stopped the safe iterate
  std::vector<Local> stuck_;                 ///< pairs that stopped it last
  std::vector<Contact> contacts_;
  std::vector<ContactRecord*> touches_; ///< of the contacts, into `touched_`
  std::vector<ContactRow> rows_;
  ContactMemory at_home_; ///< of the last step, what no rank has asked for yet
  std::unordered_map<ContactKey, ContactRecord, HashOfKey> touched_; ///< in this step
  std::vector<Vec3> gradient_;
  std::vector<double> inverse_mass_, scaled_compliance_, residual_, tolerance_, change_, mu_;
  std::vector<double> pulled_; ///< by the step's programs on local edges, kg m
  std::vector<double> guess_;  ///< where the first of them starts, on owned edges
};

} // namespace taut
