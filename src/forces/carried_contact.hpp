#pragma once
#include "src/forces/force.hpp"

namespace taut {

/// The contact forces that lasted through the step before, carried into this one as CarriedTension carries
/// tension: without them, cloth that hangs over an edge is predicted inside it. The projection with contact
/// may take back all of it, but no more: a contact never pulls. A constraint force, so it has no energy.
class CarriedContact : public Force {
public:
  /// `cloth` must outlive the force.
  explicit CarriedContact(const Cloth& cloth) : cloth_(cloth) {}

  std::string_view name() const override { return "carried_contact"; }
  double energy(const State&) const override { return 0; }
  void add_to(StepSystem& system, const State& state) override {
    for (Local i = 0; i < cloth_.mesh.vertices.owned; ++i)
      system.add_force(i, state.multipliers.carried_contact_force[i]);
  }

private:
  const Cloth& cloth_;
};

} // namespace taut
