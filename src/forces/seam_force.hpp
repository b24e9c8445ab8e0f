#pragma once
#include "src/config/scene.hpp"
#include "src/forces/force.hpp"
#include "src/forces/string_law.hpp"
#include "src/linear/pattern.hpp"

namespace taut {

/// Draws the two edges of every seam together: a string from each vertex to that which it is sewn to, whose
/// length L(t) shrinks smoothly from what it is at rest to nothing in the time of sewing, and which pulls by
/// StringLaw for e = max(|d| - L, 0), so that no seam ever pulls with more than F = `force` times the length
/// of seam at the vertex. It does so where its ends are more than `held` of that length apart. Strings from
/// front to back, along y, shrink in the first part of that time, the others in the last: tubes, as legs and
/// sleeves, are around their limbs before they are drawn to the side.
///
/// A seam counts as closed where its ends are nearer than `closed` of that length, at one end or the other:
/// each goes half of that when they become one, and the cells beside them, strained by up to a fifth, are
/// relaxed from there (Simulation::relax). Waiting for less is a matter of luck: what the prediction draws
/// together the projection, which moves in the metric of masses, opens again by up to a tenth of an edge.
/// Where a fold of the cloth itself lies in between, at necks and in gathers, nothing closes them further:
/// what counts as closed grows to `closed_late` half way between the time of sewing and its limit.
class SeamForce : public Force {
public:
  /// Of a string, over the length of seam at its vertex.
  static constexpr double held = 2e-3, closed = 0.4, closed_late = 1;

  /// What counts as the length of seam at a vertex at least, over the mean: at a corner of tiny edges there
  /// is hardly any, and nothing would draw it together.
  static constexpr double least_length = 0.3;

  /// `cloth` must outlive the force. Collective.
  SeamForce(const Cloth& cloth, const Pattern& pattern, const config::Sewing& sewing);

  std::string_view name() const override { return "seams"; }
  double energy(const State& state) const override;
  /// At the end of the step, that is with L(t + dt).
  void add_to(StepSystem& system, const State& state) override;

private:
  struct String {
    std::array<Local, 2> ends; ///< a vertex, and that which it is sewn to
    double length;             ///< m, at the start
    bool is_first;             ///< from front to back
    StringLaw law;
    Pattern::Slots<2> slots;
  };
  double length_at(const String& string, double time) const; ///< m

  const Cloth& cloth_;
  double time_; ///< s
  std::vector<String> strings_;
};

/// How much seam belongs to a vertex at the edge of a panel, m: half of what is around it makes a square.
inline double seam_length_at(const Cloth& cloth, Local vertex) {
  return std::sqrt(2 * cloth.measure[vertex]);
}

/// A pair of vertices that are to be sewn together, by original numbers, and how far they are apart.
struct OpenSeam {
  double distance = 0;    ///< m
  double over_closed = 0; ///< times the distance at which they count as closed; 0 if there are no seams
  Global vertex = -1, joint = -1;
  Vec3 place = Vec3::Zero(); ///< m, in the middle
};

/// The pair that is farthest from being closed at this time. Collective.
OpenSeam widest_seam(const Cloth& cloth, const State& state, const config::Sewing& sewing);

} // namespace taut
