#pragma once
#include "src/contact/contact_search.hpp"
#include "src/contact/obstacles.hpp"

namespace taut {

/// Tells whether the closest points of a pair are where its obstacle is nearest. Where a vertex of cloth is
/// above one triangle of a flat side, the point of the next one that is closest to it is on their common
/// edge, and the direction from there is aslant: to keep off in that direction would be to catch at the edge.
/// From an edge or a corner of a body, directions to what it is nearest to make no acute angle with the way
/// into any of its triangles.
class NormalCones {
public:
  /// `obstacles` must outlive it. Not collective.
  explicit NormalCones(const Obstacles& obstacles);

  /// Of a pair with an obstacle, whose vertices are those from `first` on in `field` (m); directions may be
  /// outside by an angle whose sine is `aslant`.
  bool holds(const Pair& pair, const Approach& here, std::span<const Vec3> field, Local first,
             double aslant) const;

private:
  std::vector<std::vector<Local>> neighbours_;                  ///< of each vertex, by edges
  std::map<std::array<Local, 2>, std::vector<Local>> opposite_; ///< of each edge, corners of its triangles
};

} // namespace taut
