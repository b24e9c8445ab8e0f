#pragma once
#include "src/contact/closest.hpp"

#include <span>

namespace taut {

enum class PairKind : std::int8_t { vertex_face, edge_edge, vertex_edge, vertex_plane };

/// Two features that may meet: vertex 0 and the triangle (1, 2, 3), the edges (0, 1) and (2, 3), vertex 0 and
/// the edge (1, 2), which may be a point, or vertex 0 and the plane through vertex 1. Vertices are places in
/// contact fields (ContactSearch).
struct Pair {
  std::array<Local, 4> vertices;
  PairKind kind;
  std::int16_t body; ///< the obstacle one of them belongs to; -1: both are cloth
  double radius;     ///< m of the features together
  Vec3 normal;       ///< of the plane
};

/// How two features stand to each other: sum_i weights[i] x_i = (gap + radius) normal.
struct Approach {
  std::array<double, 4> weights;
  Vec3 normal; ///< of length 1, from the second feature to the first
  double gap;  ///< m between them; not positive where they meet

  /// m, from the second to the first.
  Vec3 offset(const Pair& pair) const { return (gap + pair.radius) * normal; }
};

Approach approach(const Pair& pair, const Four& x);

/// The four places of a pair in a field.
inline Four at(const Pair& pair, std::span<const Vec3> field) {
  const auto& v = pair.vertices;
  return {field[v[0]], field[v[1]], field[v[2]], field[v[3]]};
}

/// sum_i weights[i] x_i in a field: of positions, from the second of two features to the first.
inline Vec3 between(const std::array<Local, 4>& vertices, const std::array<double, 4>& weights,
                    std::span<const Vec3> field) {
  Vec3 sum = Vec3::Zero();
  for (int i = 0; i < 4; ++i) sum += weights[i] * field[vertices[i]];
  return sum;
}

/// The fastest that any vertex of one feature comes towards any of the other along `normal` if the vertices
/// move by `u`; negative if all recede.
double closing_speed(const Pair& pair, const Four& u, const Vec3& normal);

/// The largest fraction of the motion x -> x + u, at most 1, on all of which the gap of the pair stays at or
/// above `floor` (m, below the gap at x). Conservative additive advancement [Li et al. 2021, ACCD] with the
/// bound that a direction which separates two convex features gives: as long as the vertices do not use up
/// their separation along it, the features stay apart. 0 where a position or a motion is not a number.
double safe_fraction(const Pair& pair, const Four& x, const Four& u, double floor);

} // namespace taut
