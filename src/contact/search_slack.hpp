#pragma once
#include "src/state/cloth.hpp"

namespace taut {

/// How far the vertices of a target stray from where a search for contacts took them to end, and how far they
/// may before it has to be made anew.
class SearchSlack {
public:
  /// `slack` in m. `cloth` must outlive it.
  SearchSlack(const Cloth& cloth, double slack);

  /// A search is made around `target` (m, local vertices, ghosts current).
  void note_search(std::span<const Vec3> target);

  /// The target is here now; false if a vertex has strayed too far. Collective.
  bool holds(std::span<const Vec3> target);

  std::span<const double> values() const { return slack_; }    ///< m, of local vertices
  std::span<const double> strayed() const { return strayed_; } ///< the same, the farthest since the search

private:
  const DistributedMesh& mesh_;
  std::vector<double> slack_, strayed_; ///< m
  std::vector<Vec3> searched_;          ///< m
};

} // namespace taut
