#pragma once
#include "src/contact/box_tree.hpp"
#include "src/contact/obstacles.hpp"

namespace taut {

/// How far places are from the surfaces of all obstacles, however far that is: ease, where cloth is worn.
/// Nothing is collective.
class Clearance {
public:
  /// `obstacles` must outlive it.
  explicit Clearance(const Obstacles& obstacles) : obstacles_(obstacles) {}

  /// Of each place the distance to the nearest surface at `time`, m: as Obstacles::nearest has it.
  std::vector<double> measure(std::span<const Vec3> places, double time);

private:
  const Obstacles& obstacles_;
  BoxTree tree_;
  std::vector<Vec3> bodies_; ///< m, where the tree has them
};

} // namespace taut
