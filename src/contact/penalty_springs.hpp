#pragma once
#include "src/contact/contact_scene.hpp"
#include "src/contact/thickness.hpp"
#include "src/forces/force.hpp"

namespace taut {

/// Stiff damped springs between features that come nearer than the thickness [BW98 section 6], implicit as
/// all that is stiff. A pair has one in a step if in free flight it would end nearer than the thickness:
///
///     f = k (thickness - gap(x + h v')) - d n . sum_i w_i v'_i,
///
/// along its normal n at the start. Friction is Coulomb's, lagged: a damping of the slip by the normal force
/// at the start over the speed of the slip, which holds up to a creep of 5 mm/s. Nothing keeps features from
/// passing each other within a step.
///
/// Between cloth and obstacles it acts only where corners and edges of a mesh meet faces and edges of the
/// cloth; vertices of the cloth are kept by SolidConstraints.
///
/// Its energy is left out of the balance: it is stored and given back within few steps.
class PenaltySprings : public Force {
public:
  /// `cloth` and `obstacles` must outlive the force. Throws InputError for a thickness that the mesh cannot
  /// have. Collective.
  PenaltySprings(const Cloth& cloth, const Obstacles& obstacles, const Case& input);

  std::string_view name() const override { return "penalty"; }
  double energy(const State&) const override { return 0; }
  void add_to(StepSystem& system, const State& state) override; ///< Collective.

private:
  struct Spring;
  std::optional<Spring> spring(const Pair& pair, double dt) const;
  bool is_solid(const Pair& pair) const;
  void find_pairs(const State& state, double dt);

  config::Contact contact_;
  config::Gravity gravity_;
  Thickness thickness_;
  double stiffness_, damping_;
  ContactScene scene_; ///< of the step in hand; no memory from one to the next
  std::vector<Vec3> displacement_;
};

} // namespace taut
