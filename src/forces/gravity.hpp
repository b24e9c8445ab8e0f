#pragma once
#include "src/forces/force.hpp"

namespace taut {

/// m g on every vertex, with the gravity at the end of the step.
class Gravity : public Force {
public:
  /// `cloth` must outlive the force.
  Gravity(const Cloth& cloth, config::Gravity acceleration)
      : cloth_(cloth), acceleration_(std::move(acceleration)) {}

  std::string_view name() const override { return "gravity"; }
  bool is_internal() const override { return false; }
  double energy(const State& state) const override;
  void add_to(StepSystem& system, const State& state) override;

private:
  const Cloth& cloth_;
  config::Gravity acceleration_;
};

} // namespace taut
