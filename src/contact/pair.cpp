#include "src/contact/pair.hpp"

#include <algorithm>

namespace taut {

namespace {

constexpr int most_advances = 60;
constexpr double part_of_bound = 0.9; // of a conservative bound, so that rounding cannot use it up

Closest closest(PairKind kind, const Four& x) {
  if (kind == PairKind::vertex_face) return closest_vertex_face(x);
  if (kind == PairKind::edge_edge) return closest_edge_edge(x);
  Closest c = closest_edge_edge({x[0], x[0], x[1], x[2]});
  c.weights = {1, c.weights[2], c.weights[3], 0};
  return c;
}

} // namespace

Approach approach(const Pair& pair, const Four& x) {
  if (pair.kind == PairKind::vertex_plane)
    return {{1, -1, 0, 0}, pair.normal, pair.normal.dot(x[0] - x[1]) - pair.radius};
  const Closest c = closest(pair.kind, x);
  const Vec3 normal = c.distance > 0 ? Vec3(c.offset / c.distance) : Vec3(Vec3::Zero());
  return {c.weights, normal, c.distance - pair.radius};
}

double closing_speed(const Pair& pair, const Four& u, const Vec3& normal) {
  const double a = normal.dot(u[0]), b = normal.dot(u[1]), c = normal.dot(u[2]), d = normal.dot(u[3]);
  switch (pair.kind) {
  case PairKind::vertex_face:
    return std::max({b, c, d}) - a;
  case PairKind::edge_edge:
    return std::max(c, d) - std::min(a, b);
  case PairKind::vertex_edge:
    return std::max(b, c) - a;
  case PairKind::vertex_plane:
    return b - a;
  }
  return 0;
}

double safe_fraction(const Pair& pair, const Four& x, const Four& u, double floor) {
  double t = 0;
  for (int k = 0; k < most_advances; ++k) {
    Four now;
    for (int i = 0; i < 4; ++i) now[i] = x[i] + t * u[i];
    const Approach here = approach(pair, now);
    const double speed = closing_speed(pair, u, here.normal), room = here.gap - floor;
    if (room >= (1 - t) * speed) return 1.0;
    const double way = part_of_bound * room / speed;
    if (!(room > 0 && way > 0)) return t; // also where something is not a number
    t += way;
  }
  return t;
}

} // namespace taut
