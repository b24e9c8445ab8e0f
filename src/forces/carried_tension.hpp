#pragma once
#include "src/forces/force.hpp"

namespace taut {

/// The tension that held the cloth in the step before, carried into this one: force -L(q+) x and stiffness
/// L(q+), where L is the Laplacian of the edges weighted by the force density q+ = max(q, 0) in N/m. The
/// prediction of the step then lies near the constraint manifold already, and the projection only corrects
/// the change of tension. A constraint force, so it has no energy. It is internal: total momentum is kept.
class CarriedTension : public Force {
public:
  /// `cloth` and `pattern` must outlive the force.
  CarriedTension(const Cloth& cloth, const Pattern& pattern);

  std::string_view name() const override { return "carried_tension"; }
  double energy(const State&) const override { return 0; }
  void add_to(StepSystem& system, const State& state) override;

private:
  const Cloth& cloth_;
  std::vector<std::int32_t>
      slots_; ///< of (vertex, other) for all edge ends around owned vertices, in the mesh's order
};

} // namespace taut
