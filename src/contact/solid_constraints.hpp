#pragma once
#include "src/contact/contact_scene.hpp"
#include "src/contact/thickness.hpp"
#include "src/forces/force.hpp"
#include "src/state/freedom.hpp"

namespace taut {

/// Vertices of the cloth kept on obstacles, for the penalty model [BW98 sections 5 and 6].
///
/// A vertex found nearer to an obstacle than the thickness is constrained from then on: along the normal n it
/// moves with the obstacle's surface, and its position is altered by what is missing of the thickness, at
/// once and without giving it a velocity,
///
///     x' = x + h v' + y,   y = (thickness - gap) n.
///
/// It is let go when the force that holds it becomes attractive. Friction is Coulomb's, by the normal force
/// of the step before: a vertex sticks in all directions where friction can stop its slip within the step,
/// and until to hold it takes more than friction has; otherwise a force acts against its slip. Faces and
/// edges of the cloth are not constrained: see PenaltySprings for those that a mesh's corners meet.
///
/// What it remembers of the step before, the force on each vertex, is the state's `contact_force`.
class SolidConstraints {
public:
  /// `cloth` and `obstacles` must outlive it. Throws InputError for a thickness that the mesh cannot have.
  /// Collective.
  SolidConstraints(const Cloth& cloth, const Obstacles& obstacles, const Case& input);

  /// Decides which vertices are constrained in the step from `state` over `dt` seconds. Pinned ones, those
  /// not free in `freedom` (local vertices), are left alone. Collective.
  void find(const State& state, double dt, const Freedom& freedom);

  /// y of local vertices, ghosts current; m. Until the next call of `find`.
  std::span<const Vec3> alteration() const { return alteration_; }

  /// Restricts the constrained vertices, ghosts too, and gives them in the directions in which they are the
  /// velocity of the surface. Not collective.
  void prescribe(Freedom& freedom, std::vector<Vec3>& velocities) const;

  /// Lets go of the vertices that the prediction needed `reaction` (N, of owned ones) to pull on; true if
  /// there were any on any rank: the prediction then has to be made again. Collective.
  bool let_go(std::span<const Vec3> reaction);

  /// Lets those that stick move along the surface again: for the projection, which cannot keep the length of
  /// an edge whose ends are both held. Not collective.
  void loosen(Freedom& freedom) const;

  /// The friction of those that slip. Not collective.
  void add_friction(StepSystem& system) const;

  /// Takes the forces of obstacles out of the reactions of a step, and notes them with those of friction as
  /// what presses, and for the next step. Collective over neighbours.
  void note_forces(Candidate& candidate) const;

private:
  enum class Hold : std::int8_t { none, slips, sticks };
  /// What a vertex rests on.
  struct Rest {
    Hold hold = Hold::none;
    Vec3 normal = Vec3::Zero();
    Vec3 surface = Vec3::Zero();  ///< m/s
    Vec3 friction = Vec3::Zero(); ///< N, on one that slips
  };
  /// What is nearest to a vertex of this rank.
  struct Nearest {
    double gap = HUGE_VAL; ///< m
    double thickness = 0;  ///< m that the two are to keep
    Vec3 normal = Vec3::Zero(), surface = Vec3::Zero();
    double friction = 0;

    bool operator<(const Nearest& other) const { return gap < other.gap; }
  };

  std::vector<Nearest> nearest(const State& state, double dt);
  Rest rest_on(const Nearest& nearest, const Vec3& force, const Vec3& momentum, double dt) const;

  config::Contact contact_;
  Thickness thickness_;
  ContactScene scene_;
  std::vector<Rest> rests_;      ///< of local vertices
  std::vector<Vec3> alteration_; ///< of local vertices
};

/// The friction of SolidConstraints, among the forces of the prediction.
class SolidFriction : public Force {
public:
  /// `solids` must outlive the force.
  explicit SolidFriction(const SolidConstraints& solids) : solids_(solids) {}

  std::string_view name() const override { return "solid_friction"; }
  double energy(const State&) const override { return 0; }
  void add_to(StepSystem& system, const State&) override { solids_.add_friction(system); }

private:
  const SolidConstraints& solids_;
};

} // namespace taut
