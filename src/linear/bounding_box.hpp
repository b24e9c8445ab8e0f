#pragma once
#include "partition/comm.hpp"
#include "partition/types.hpp"

#include <cmath>

namespace taut {

struct BoundingBox {
  Vec3 lowest, highest;
};

/// Of the points of all ranks. Collective.
inline BoundingBox bounding_box(MPI_Comm comm, std::span<const Vec3> points) {
  std::array<double, 6> box; // -lowest, highest
  box.fill(-HUGE_VAL);
  for (const Vec3& p : points)
    for (int d = 0; d < 3; ++d) {
      box[d] = std::max(box[d], -p[d]);
      box[3 + d] = std::max(box[3 + d], p[d]);
    }
  max_in_place(comm, box);
  return {-Vec3(box[0], box[1], box[2]), Vec3(box[3], box[4], box[5])};
}

} // namespace taut
