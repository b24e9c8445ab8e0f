#pragma once
#include "src/constraints/choose_set.hpp"
#include "src/filters/contact_projection.hpp"
#include "src/newton/newton_solver.hpp"
#include "src/newton/triangle_penalty.hpp"
#include "src/time/step_assembly.hpp"
#include "src/time/stepper.hpp"

namespace taut {

/// Newton's method on the whole step: end positions x and multipliers mu = h^2 lambda together, of
///
///     M (x - x0 - h v0) - h^2 f + J^T mu = 0,      C(x) - a mu = 0,
///
/// from x0 + h v0 and the multipliers of the last step, by solves of
///
///     [ H  J^T ] [ dx  ]     [ what is left of the first ]
///     [ J  -a  ] [ dmu ] = - [ of the second             ],    H = A + L(2 |mu|/l),
///
/// where A = M + h D + h^2 K is the matrix of the forces, which are linearised once a step [BW98 eq. 6], and
/// L the stiffness that tension adds across edges (of pushes: see tension_weights). It is ICD [G07
/// section 4.1] with the forces of [BW98] inside: the first solve is prediction and projection in one.
///
/// A prediction in the metric of A followed by a projection in the metric of masses has no equilibrium as its
/// fixed point: what the prediction takes for pushes of edges is not what the projection takes back, and each
/// step leaves a velocity. Here nothing is left out of what is to vanish, only of its derivative; so a cloth
/// at rest stays so, and what one step leaves of the equations the next one starts from.
///
/// Where edges turn much in a step, the linearised system is a poor guide: along x0 + h v0 those of a flag
/// come to be strained by half their length and more. So before the first solve and after each, a strain
/// beyond a tenth is taken back by Fast Projection [G07 algorithm 1], in the metric of masses, as long as
/// that makes it smaller; what it adds to mu balances what it does to inertia, and the rest is left to the
/// next solve. Smaller strains are not projected: in the metric of masses a taut thread of a fine mesh
/// answers one of 1 % with zigzags of 40 %. What rests is never projected, so equilibrium stays a fixed
/// point.
///
/// With contact, what solves leave of it is corrected by ContactProjection, and so is what single triangles
/// strain beyond their bound; TrianglePenalty leaves little of that.
///
/// A step is done when its strain is within the limit and what is left of the equations would move the cloth
/// (NewtonSolver::movement) by at most `residual` times what gravity, or a stronger acceleration, does in the
/// step. Strain alone says nothing of that: where solves were stopped by it, the cloth fell in slow motion.
/// Solves leave a tenth of it, so that in most steps one is enough, and what buckles, where one solve is far
/// from enough, is accepted all the same. With contact, solves also go on until contacts agree on which of
/// them press, or the forces that are left are too small for that to matter.
template<ConstraintSetInNewton Set>
class NewtonStep : public Stepper {
public:
  /// Collective.
  NewtonStep(const StepperParts& parts, const Case& input);

  StepReport propose(const State& state, double dt, Candidate& candidate) override;
  void store_history(State& state, double dt) const override { integrator_.store_history(state, dt); }

private:
  void begin(const StepStart& start, Candidate& candidate);
  void keep_violation(const StepStart& start);
  void iterate(const StepStart& start, Candidate& candidate, StepReport& report);
  bool is_settled(double dt) const;
  bool is_balanced(double dt) const;
  double project(const StepStart& start, Candidate& candidate, StepReport& report);
  double unit_of_movement(const StepStart& start, const Candidate& candidate);
  bool solve(double dt, double unit, Candidate& candidate, StepReport& report);
  void find_residual(double dt, const Candidate& candidate);
  void stiffen();
  bool has_contacts() const { return contact_ && contact_->foreseen().count() > 0; }
  std::vector<double> metric() const;
  void find_resistance();
  void shorten_change();
  void find_reaction(double dt, Candidate& candidate) const;
  void correct(const StepStart& start, Candidate& candidate, StepReport& report);

  const Cloth& cloth_;
  const Pins& pins_;
  config::Inextensibility options_;
  double gravity_;      ///< m/s^2; 1 where there is none
  double weight_;       ///< N, of the whole cloth
  double longest_step_; ///< s
  Integrator integrator_;
  StepAssembly assembly_;
  Set set_;
  NewtonSolver<Set> solver_;
  std::unique_ptr<ContactProjection<Bounded<Set>>> contact_; ///< none without contact
  std::optional<TrianglePenalty> triangles_;                 ///< none where they have no bound
  FilteredOperator stiffness_;
  Freedom freedom_;
  std::vector<std::int32_t> slots_;     ///< of tension's stiffness, see edge_slots
  std::vector<double> weights_, added_; ///< 2 |mu|/l of local edges: now, and in the matrix
  std::vector<double> rows_, change_;   ///< of owned rows
  std::vector<double> kept_;            ///< what the step need not correct, of owned rows
  std::vector<Vec3> residual_, left_;   ///< of owned vertices: with what pins take, without
  std::vector<Vec3> dx_, moved_;        ///< of local vertices; of owned ones, in the step so far
};

} // namespace taut
