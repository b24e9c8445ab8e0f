#pragma once
#include "src/forces/force.hpp"

namespace taut {

/// m g on every vertex.
class Gravity : public Force {
public:
  /// `cloth` must outlive the force; `acceleration` in m/s^2.
  Gravity(const Cloth& cloth, const Vec3& acceleration) : cloth_(cloth), acceleration_(acceleration) {}

  std::string_view name() const override { return "gravity"; }
  bool is_internal() const override { return false; }
  double energy(const State& state) const override;
  void add_to(StepSystem& system, const State& state) override;

private:
  const Cloth& cloth_;
  Vec3 acceleration_;
};

} // namespace taut
