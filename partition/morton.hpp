#pragma once
#include "partition/types.hpp"

namespace taut {

/// Spreads the lowest 21 bits of `v` so that two zero bits stand between neighbours.
inline std::uint64_t spread_bits(std::uint64_t v) {
  v &= 0x1fffff;
  v = (v | v << 32) & 0x1f00000000ffff;
  v = (v | v << 16) & 0x1f0000ff0000ff;
  v = (v | v << 8) & 0x100f00f00f00f00f;
  v = (v | v << 4) & 0x10c30c30c30c30c3;
  v = (v | v << 2) & 0x1249249249249249;
  return v;
}

/// The place of a point on the Morton curve through the cube with corner `low` and side `side`: near in
/// number means near in space.
inline std::uint64_t morton_key(const Vec3& point, const Vec3& low, double side) {
  const Vec3 cell = (point - low) / side * double(0x1fffff);
  return spread_bits(std::uint64_t(cell[0])) | spread_bits(std::uint64_t(cell[1])) << 1 |
         spread_bits(std::uint64_t(cell[2])) << 2;
}

} // namespace taut
