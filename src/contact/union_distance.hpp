#pragma once
#include "src/config/case.hpp"

namespace taut {

/// A function of space that is negative inside the union of solids, and how it changes.
///
/// Of the signed distances d_i of the parts and the blend radius r it is
///
///     d = max(r, min_i d_i) - |u|,   u_i = max(r - d_i, 0),
///
/// the distance from the nearest part where no other is nearer than r. Where the surfaces of two parts meet
/// at a right angle, d = 0 is a fillet of the radius r: the circle (r - d_1)^2 + (r - d_2)^2 = r^2 around d_1
/// = d_2 = r. (The round union of the hg_sdf library, for any number of parts.) It depends on no order of the
/// parts; between n of them it grows at most sqrt(n) times as fast as distance does.
class UnionDistance {
public:
  /// `input` must outlive it.
  explicit UnionDistance(const config::Union& input) : input_(input) {}

  struct Value {
    double distance; ///< m
    Vec3 gradient;
  };
  Value at(const Vec3& x) const;

  /// False if the surface is nowhere within `radius` (m) of `x`. The distance m from the nearest part changes
  /// no faster than x does; on the surface |u| = r, so the largest of n u_i is at least r / sqrt(n), and m is
  /// between 0 and r (1 - 1/sqrt(n)).
  bool may_be_near(const Vec3& x, double radius) const;

private:
  const config::Union& input_;
};

} // namespace taut
