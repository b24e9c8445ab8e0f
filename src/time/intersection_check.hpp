#pragma once
#include "src/contact/intersections.hpp"
#include "src/time/observer.hpp"

namespace taut {

/// Tests the result for intersections, at frames or at every step, by a test of its own (Intersections).
class IntersectionCheck : public Observer {
public:
  /// `cloth` must outlive it. Collective.
  IntersectionCheck(const Cloth& cloth, const Case& input);

  /// Throws InputError, naming places, if the cloth intersects something in `state`. Collective.
  void refuse(const State& state);

  void after_step(const State& state, const StepRecord& record) override;
  void after_frame(const State& state, Global frame) override;

  Global count() const { return count_; } ///< over all tests so far

  /// Where the first was found, in words; empty if none was.
  const std::string& first() const { return first_; }

private:
  void look(const State& state);

  const Cloth& cloth_;
  config::CheckAt when_;
  Obstacles obstacles_;
  Intersections test_;
  std::vector<Vec3> bodies_;
  Global count_ = 0;
  std::string first_;
};

} // namespace taut
