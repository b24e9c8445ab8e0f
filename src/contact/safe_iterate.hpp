#pragma once
#include "src/contact/contact_scene.hpp"
#include "src/contact/rows.hpp"
#include "src/contact/thickness.hpp"

#include <unordered_set>

namespace taut {

/// Where cloth and obstacles have come in a step without ever intersecting, on their way to the scene's
/// target. It moves by the largest fraction of that way on which, by conservative advancement, no pair of
/// features comes too near. Pairs that stopped it are remembered until the step ends: they get a row whatever
/// their distance.
class SafeIterate {
public:
  /// Both must outlive it.
  SafeIterate(ContactScene& scene, const Thickness& thickness) : scene_(scene), thickness_(thickness) {}

  /// At the start of the scene's step. Not collective.
  void begin();

  /// What it still has before it.
  Motion motion() const { return ContactScene::between(here_, scene_.target); }

  /// The search has other pairs than when they were looked at last, but the first `known` are the same. Not
  /// collective.
  void keep_pairs(std::size_t known);

  /// Distances and directions at this place, of all pairs but the first `known`. Collective over neighbours.
  void measure_gaps(std::size_t known);

  /// The fraction of the way to the target on which no pair comes too near, the same for all vertices: what
  /// moves together would come as near as it moves if some of it stayed behind, and the search does not look
  /// so far. 0 for a target that is not a number. Collective.
  double safe_fraction_to_target();

  /// The smallest gap, in m, of all pairs where the target is, to which it was safe to go; infinite if there
  /// are none. Collective.
  double smallest_gap_at_target() const;

  /// Not collective.
  void move(double fraction);

  /// m, of the vertex that is farthest from its target. Collective.
  double distance_behind() const;

  /// Gives up the way of the vertices that hold up all others: their target is where they are. Collective.
  void release_stuck();

  /// The first of the pairs that stopped it last, in words; empty if nothing did. Collective.
  std::string what_stopped() const;

  const std::vector<Vec3>& cloth() const { return here_.cloth; } ///< m, of local vertices
  std::span<const Vec3> field() const { return field_; }         ///< as gaps were measured last
  const Approach& approach_of(std::size_t pair) const { return approaches_[pair]; }
  bool was_stopped_by(std::size_t pair) const { return has_stopped_[pair]; } ///< in this step

private:
  double safe_fraction_of(const Pair& pair, const Approach& here, const Four& way) const;

  ContactScene& scene_;
  const Thickness& thickness_;
  Scene here_;
  std::vector<Vec3> field_;
  std::vector<Approach> approaches_;                  ///< of the pairs
  std::vector<char> has_stopped_;                     ///< of the pairs: whether they are blocked
  std::unordered_set<ContactKey, HashOfKey> blocked_; ///< pairs that stopped it
  std::vector<Local> stuck_;                          ///< pairs that stopped it last
};

} // namespace taut
