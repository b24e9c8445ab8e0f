#pragma once
#include "partition/types.hpp"

#include <array>

/// Closest points of two primitives: pure functions of the positions of four vertices.
namespace taut {

using Four = std::array<Vec3, 4>;

/// The pair of closest points: sum_i weights[i] x_i is the vector from the second to the first.
struct Closest {
  std::array<double, 4> weights;
  Vec3 offset;     ///< m
  double distance; ///< |offset|
};

/// Of vertex 0 and the triangle (1, 2, 3) [Ericson, Real-Time Collision Detection, 5.1.5].
Closest closest_vertex_face(const Four& x);

/// Of the segments (0, 1) and (2, 3), each of which may be a point [Ericson 5.1.9].
Closest closest_edge_edge(const Four& x);

/// Whether a segment passes a triangle [Moeller and Trumbore 1997].
bool passes(const Vec3& from, const Vec3& to, const std::array<Vec3, 3>& triangle);

} // namespace taut
