#pragma once
#include "src/contact/contact_search.hpp"
#include "src/contact/obstacles.hpp"

namespace taut {

/// Tells whether the closest points of a pair are where its obstacle is nearest. Where a vertex of cloth is
/// above one triangle of a flat side, the point of the next one that is closest to it is on their common
/// edge, and the direction from there is aslant: to keep off in that direction would be to catch at the edge.
/// From an edge or a corner of a body, directions to what it is nearest to make no acute angle with the way
/// into any of its triangles.
///
/// Directions may be aslant by 0.02: a contact that will be inside its cone at the end of the step must be
/// known at the start. Where an element of cloth rests on two corners of a body, it rocks otherwise. Each
/// step knows of one corner only, and tilts the element into the other (src/newton/README.md#contact). What
/// slides is held back by at most that part of what presses.
class NormalCones {
public:
  /// `obstacles` must outlive it. Not collective.
  explicit NormalCones(const Obstacles& obstacles);

  /// Of a pair with an obstacle, whose vertices are those from `first` on in `field` (m).
  bool holds(const Pair& pair, const Approach& here, std::span<const Vec3> field, Local first) const;

private:
  std::vector<std::vector<Local>> neighbours_;                  ///< of each vertex, by edges
  std::map<std::array<Local, 2>, std::vector<Local>> opposite_; ///< of each edge, corners of its triangles
};

} // namespace taut
