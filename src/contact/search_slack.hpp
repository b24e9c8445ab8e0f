#pragma once
#include "src/state/cloth.hpp"

namespace taut {

/// How far the vertices of a target stray from where a search for contacts took them to end, and how far they
/// may: twice as far as around them in the step before, so that most steps search once. It bounds what is
/// looked at, not what is found.
class SearchSlack {
public:
  /// At least `least` (m) is allowed. `cloth` must outlive it. Collective.
  SearchSlack(const Cloth& cloth, double least);

  /// Takes over what the last step has shown. Collective over neighbours.
  void begin_step();

  /// A search is made around `target` (m, local vertices).
  void note_search(std::span<const Vec3> target);

  /// The target is here now; false if a vertex has strayed beyond its slack. Collective.
  bool holds(std::span<const Vec3> target);

  std::span<const double> values() const { return slack_; }    ///< m, of local vertices, ghosts current
  std::span<const double> strayed() const { return strayed_; } ///< the same, since the last search

private:
  std::vector<double> largest_around(std::span<const double> values) const;

  const DistributedMesh& mesh_;
  double least_;
  std::vector<double> most_;    ///< m
  std::vector<double> slack_;   ///< m
  std::vector<double> strayed_; ///< m
  std::vector<double> before_;  ///< m, the same over the searches of this step that are no more
  std::vector<Vec3> searched_;  ///< m
};

} // namespace taut
