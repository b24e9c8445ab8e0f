#pragma once
#include "src/contact/contact_rows.hpp"
#include "src/filters/contact_qp.hpp"
#include "src/filters/fast_projection.hpp"
#include "src/filters/velocity_filter.hpp"

namespace taut {

/// What else ContactProjection has to know.
struct ContactProjectionOptions {
  config::Inextensibility limits; ///< as of Resolved
  config::Contact contact;
  double gravity;                 ///< m/s^2
  double longest_step;            ///< s
  std::vector<Element> strings{}; ///< that obstacles stop
};

/// Fast Projection with contact inside it: from the candidate end positions y, constraints as equations and
/// contacts as inequalities in one quadratic program, around an iterate x that never intersects
/// (SafeIterate).
///
///     minimise 1/2 |dy|_M^2  subject to  C(y) + J dy = 0,  n . sum_i w_i (y + dy)_i >= thickness
///
/// is solved for its multipliers (ContactQp). Then x moves towards y as far as is safe; pairs that stopped it
/// get a row in the next iteration whatever their distance. The step is good when x has arrived and the
/// measured strain is within the limit. Contacts, their friction and their memory are those of ContactRows.
///
/// The filter remembers nothing from step to step: what the last one projected is part of the state
/// (`Multipliers::projection_tension`), in newtons, because the next step may be of another size.
///
/// Where no contact is in reach, neither of the candidate nor of where Fast Projection leads from it, this is
/// Fast Projection.
template<ConstraintSet Set>
class ContactProjection : public VelocityFilter {
public:
  /// `cloth` and `obstacles` must outlive the filter. Collective.
  ContactProjection(const Cloth& cloth, const Obstacles& obstacles, Thickness thickness,
                    const ContactProjectionOptions& options);

  FilterReport apply(const State& start, double dt, const Freedom& freedom, Candidate& candidate) override;

  /// `apply` in two halves around what proposes the candidate, for a stepper that has to know contacts
  /// before: first those at the start of the step, of a cloth that goes on with these velocities,
  FilterReport foresee(const State& start, double dt, const Freedom& freedom,
                       std::span<const Vec3> velocities);
  /// what they do to the candidate,
  AugmentedContacts& foreseen() { return foreseen_; }
  /// and what is left to correct. All collective.
  FilterReport correct(const State& start, double dt, const Freedom& freedom, Candidate& candidate);

private:
  void begin(const State& start, double dt, const Freedom& freedom, std::span<const Vec3> velocities);
  void find_pairs();
  static bool is_torn(double strain, FilterReport& report);
  bool is_kept(double strain, FilterReport& report);
  void iterate(const State& start, double dt, const Freedom& freedom, Candidate& candidate,
               FilterReport& report);
  bool ends_alone(const State& start, double dt, const Freedom& freedom, Candidate& candidate,
                  FilterReport& report);
  void update_pairs(std::size_t known);
  std::string project(FilterReport& report);
  void note_contacts(Candidate& candidate);
  void count_contacts(FilterReport& report) const;
  bool ends_after_moving(double asked, FilterReport& report);
  void propose(const State& start, double dt, Candidate& candidate) const;

  ContactProjectionOptions options_;
  Thickness thickness_;
  ContactScene scene_;
  SafeIterate safe_;
  ContactRows rows_;
  AugmentedContacts foreseen_;
  FastProjection<Set> alone_;
  Set set_;
  ContactQp<Set> qp_;
  int iteration_ = 0;             ///< of the step in hand
  QpGuess guess_ = QpGuess::zero; ///< of the next program
  double behind_ = 0; ///< m, how far the safe iterate was from the target after the last iteration
};

} // namespace taut
