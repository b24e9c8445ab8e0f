#include "src/contact/yielding_body.hpp"

#include "src/contact/body_normals.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace taut {

namespace {

constexpr int few_rounds = 2;                             ///< of evening out
constexpr double around = 0, behind = 0.7, facing = -0.2; ///< cosines

/// The vertices of a body along x.
class AlongX {
public:
  explicit AlongX(std::span<const Vec3> positions) : positions_(positions), order_(positions.size()) {
    std::iota(order_.begin(), order_.end(), 0);
    std::sort(order_.begin(), order_.end(),
              [&](Local a, Local b) { return positions[a][0] < positions[b][0]; });
  }

  /// Whether `holds` of a vertex within `reach` along x, and so of each that is so near.
  template<class Condition>
  bool any_near(const Vec3& p, double reach, Condition&& holds) const {
    const auto x_of = [&](Local w) { return positions_[w][0]; };
    auto w = std::ranges::lower_bound(order_, p[0] - reach, {}, x_of);
    for (; w != order_.end() && x_of(*w) <= p[0] + reach; ++w)
      if (holds(*w)) return true;
    return false;
  }

  /// The radius, at most `most`, of the largest ball that touches the surface at v on the side of `normal`
  /// and has no vertex inside; of vertices whose direction from v has a cosine above `cone` with the normal.
  double radius_at(Local v, const Vec3& normal, double most, double cone) const {
    const Vec3& p = positions_[v];
    double radius = most;
    any_near(p, 2 * most, [&](Local w) {
      const Vec3 apart = positions_[w] - p;
      if (const double deep = apart.dot(normal); deep > cone * apart.norm())
        radius = std::min(radius, radius_of_ball(apart, normal));
      return false;
    });
    return radius;
  }

private:
  std::span<const Vec3> positions_;
  std::vector<Local> order_;
};

/// The vertices that have a part of the body in front of them, and nearer than `room`, whose normal is
/// opposed to theirs.
std::vector<bool> facing_others(std::span<const Vec3> positions, std::span<const Vec3> normals,
                                const AlongX& vertices, double room) {
  std::vector<bool> faces(positions.size());
  for (std::size_t v = 0; v < faces.size(); ++v)
    faces[v] = vertices.any_near(positions[v], room, [&](Local w) {
      const Vec3 apart = positions[w] - positions[v];
      return normals[w].dot(normals[v]) < facing && apart.dot(normals[v]) > 0 &&
             radius_of_ball(apart, normals[v]) < 0.5 * room;
    });
  return faces;
}

/// Where evening out took from what is asked for, it is asked for again.
void keep_at_least(std::vector<Vec3>& ways, std::span<const Vec3> asked) {
  for (std::size_t v = 0; v < ways.size(); ++v)
    if (ways[v].norm() < asked[v].norm()) ways[v] = asked[v];
}

} // namespace

std::vector<Vec3> ways_to_room(std::span<const Vec3> positions,
                               std::span<const std::array<Local, 3>> triangles, double room) {
  const std::vector<Vec3> normals = outward_normals(positions, triangles);
  const AlongX vertices(positions);
  const std::vector<bool> faces = facing_others(positions, normals, vertices, room);
  const auto is_near_such = [&](const Vec3& p) {
    return vertices.any_near(p, room, [&](Local w) { return faces[w] && (positions[w] - p).norm() < room; });
  };
  std::vector<Vec3> ways(positions.size(), Vec3::Zero());
  for (Local v = 0; v < Local(ways.size()); ++v) {
    const double missing = 0.5 * room - vertices.radius_at(v, normals[v], 0.5 * room, around);
    if (missing > 0 && is_near_such(positions[v]))
      ways[v] = -std::min(missing, vertices.radius_at(v, -normals[v], room, behind)) * normals[v];
  }
  const std::vector<Vec3> asked = ways;
  even_out(ways, triangles, few_rounds);
  keep_at_least(ways, asked);
  return ways;
}

} // namespace taut
