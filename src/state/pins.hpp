#pragma once
#include "src/state/freedom.hpp"
#include "src/state/pin_reach.hpp"
#include "src/state/state.hpp"

#include <optional>
#include <string>

namespace taut {

/// Vertices whose motion is prescribed: at rest, or along keyframes, until they are let go; in all
/// directions, or only across a line or a plane on which they may slide.
class Pins {
public:
  /// Finds the vertices of each pin; `start` holds their start positions (local vertices). Throws InputError,
  /// naming the file and `pins.k`, for a vertex that is not there, a box without vertices, a vertex in two
  /// pins, pins that leave no vertex free, or pins that bring an edge between them over the strain limit,
  /// or vertices farther apart than the cloth between them reaches.
  /// Collective.
  Pins(const Cloth& cloth, const Case& input, std::span<const Vec3> start);

  /// For the step from state.time to state.time + dt: restricts the vertices that are pinned (local vertices,
  /// ghosts too) and gives them in `velocities`, which holds those of the start, in the directions in which
  /// they are pinned the velocity that brings them to their place. Not collective.
  void prescribe(const State& state, double dt, Freedom& freedom, std::vector<Vec3>& velocities) const;

  /// Where a vertex that is pinned is not at the place its pin has for it at state.time, the farthest of
  /// them, in words; none if there is no such vertex, up to round-off. The same on all ranks. Collective.
  std::optional<std::string> find_jump(const Cloth& cloth, const State& state) const;

  /// The sum of `reaction` over the vertices of each pin that this rank owns. Not collective.
  std::vector<Vec3> totals(const Cloth& cloth, std::span<const Vec3> reaction) const;

  Global count() const { return count_; } ///< pinned vertices over all ranks, at the start

private:
  struct Held {
    Local vertex;
    std::size_t pin;
    Vec3 start;
  };
  void check_edges(const Cloth& cloth, const Case& input) const;
  std::vector<HeldVertex> outermost(const Cloth& cloth) const;
  bool holds_fast(const Held& h) const { return !pins_[h.pin].along && !pins_[h.pin].plane; }
  void restrict_motion(const Held& h, double time, Freedom& freedom) const;

  std::vector<config::Pin> pins_;
  std::vector<Held> held_; ///< local vertices
  Global count_ = 0;
};

/// Where a point that starts at `start` is at `time`: turned, then moved; keyframes interpolated linearly,
/// the first and the last held before and after.
Vec3 place_at(const std::vector<config::Keyframe>& motion, const Vec3& start, double time);

} // namespace taut
