#pragma once
#include "partition/types.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace taut {

/// An axis-parallel box in single precision that holds everything it was grown by.
struct Box {
  std::array<float, 3> low{HUGE_VALF, HUGE_VALF, HUGE_VALF};
  std::array<float, 3> high{-HUGE_VALF, -HUGE_VALF, -HUGE_VALF};

  void include(const Vec3& p) {
    for (int k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], below(p[k]));
      high[k] = std::max(high[k], -below(-p[k]));
    }
  }
  void include(const Box& other) {
    for (int k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], other.low[k]);
      high[k] = std::max(high[k], other.high[k]);
    }
  }
  /// Grows by `r` on all sides.
  void inflate(double r) {
    for (int k = 0; k < 3; ++k) {
      low[k] = below(low[k] - r);
      high[k] = -below(-high[k] - r);
    }
  }
  bool contains(const Box& other) const {
    for (int k = 0; k < 3; ++k)
      if (other.low[k] < low[k] || other.high[k] > high[k]) return false;
    return true;
  }
  bool overlaps(const Box& other) const {
    bool apart = false; // without branches, which nobody could predict
    for (int k = 0; k < 3; ++k) {
      apart |= low[k] > other.high[k];
      apart |= other.low[k] > high[k];
    }
    return !apart;
  }

private:
  /// A float at most x, off by two units in the last place at most.
  static float below(double x) {
    constexpr float unit = 0x1p-23f, least = 0x1p-126f;
    const float rounded = float(x);
    return rounded - std::abs(rounded) * unit - least;
  }
};

using BoxPair = std::pair<Local, Local>;

/// A bounding-volume hierarchy over boxes (Embree's). Of one rank; nothing is collective.
class BoxTree {
public:
  BoxTree();
  ~BoxTree();
  BoxTree(BoxTree&&) noexcept;
  BoxTree& operator=(BoxTree&&) noexcept;

  void build(std::vector<Box> boxes);

  /// All pairs (i, j), i < j, of boxes that overlap.
  std::vector<BoxPair> pairs() const;

  /// All pairs (i, j) of a box i of this tree and a box j of `other` that overlap.
  std::vector<BoxPair> pairs_with(const BoxTree& other) const;

  /// Of what is in the boxes, that which is nearest to a place, and how far it is. `distance(i)` says it of
  /// box i, and is at least the distance of the box. -1 and HUGE_VAL of an empty tree.
  std::pair<Local, double> nearest(const Vec3& place, const std::function<double(Local)>& distance) const;

private:
  struct Scene;
  std::unique_ptr<Scene> scene_;
};

} // namespace taut
