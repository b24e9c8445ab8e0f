#pragma once
#include "src/output/findings.hpp"
#include "src/time/observer.hpp"

#include <filesystem>
#include <optional>

namespace taut {

/// Tests the result for intersections, at frames or at every step, by a test of its own (Intersections).
class IntersectionCheck : public Observer {
public:
  /// `cloth` and `obstacles` must outlive it. Not collective.
  IntersectionCheck(const Cloth& cloth, const Obstacles& obstacles, const Case& input);

  /// Tests `state`; if the cloth intersects something in it, writes all findings to `file`, whose folder is
  /// made. Whether it does. Collective.
  bool finds_in(const State& state, const std::filesystem::path& file);

  /// If the cloth intersects something in `state`, does that and throws InputError, naming the first.
  /// Collective.
  void refuse(const State& state, const std::filesystem::path& file);

  void after_step(const State& state, const StepRecord& record) override;
  void after_frame(const State& state, Global frame) override;

  Global count() const { return count_; } ///< over all tests so far

  /// Where the first was found, in words; empty if none was.
  const std::string& first() const { return first_; }

  /// All that were found the first time that any was, as a file for ParaView (findings_as_vtp). Collective.
  std::string findings() const { return findings_as_vtp(cloth_.mesh.comm, findings_); }

private:
  void count_intersections(const State& state);

  const Cloth& cloth_;
  config::CheckAt when_;
  const Obstacles& obstacles_;
  std::optional<Intersections> test_; ///< made when it is first needed: it knows every feature of the cloth
  std::vector<Vec3> bodies_;
  Global count_ = 0;
  std::string first_;
  std::vector<Intersection> findings_;
};

} // namespace taut
