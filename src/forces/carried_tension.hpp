#pragma once
#include "src/config/choices.hpp"
#include "src/forces/force.hpp"

namespace taut {

/// Not 0 for the local edges that carry pushes too: where vertices are constrained, all but the sides of
/// quads and lines. Collective if vertices are.
std::vector<char> edges_with_pushes(const DistributedMesh& mesh, config::Constrain constrain);

/// The tension that held the cloth in the step before, carried into this one: force -L(q) x and stiffness
/// L(q+), where L is the Laplacian of the edges weighted by the force density q in N/m, and q+ = max(q, 0).
/// The prediction of the step then lies near the constraint manifold already, and the projection only
/// corrects the change of tension. A constraint force, so it has no energy. It is internal: total momentum is
/// kept.
///
/// Where edges are constrained, those that push are left out of q: carried without stiffness, pushes are
/// unstable. Where averaged metrics are, q is made of few stresses, and on a triangle of any shape some of it
/// is negative though these pull: to leave that out would be to carry another stress than the multipliers
/// say, and the difference would grow from step to step.
class CarriedTension : public Force {
public:
  /// `cloth` and `pattern` must outlive the force; `pushes` as edges_with_pushes.
  CarriedTension(const Cloth& cloth, const Pattern& pattern, std::vector<char> pushes);

  std::string_view name() const override { return "carried_tension"; }
  double energy(const State&) const override { return 0; }
  void add_to(StepSystem& system, const State& state) override;

private:
  const Cloth& cloth_;
  std::vector<char> pushes_;
  std::vector<std::int32_t>
      slots_; ///< of (vertex, other) for all edge ends around owned vertices, in the mesh's order
};

} // namespace taut
