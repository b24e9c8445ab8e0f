#include "src/contact/yielding_body.hpp"

#include "src/contact/body_normals.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace taut {

namespace {

constexpr int few_rounds = 2;                    ///< of evening out
constexpr double all_around = 0, opposite = 0.7; ///< cosines

/// The vertices of a body along x.
class AlongX {
public:
  explicit AlongX(std::span<const Vec3> positions) : positions_(positions), order_(positions.size()) {
    std::iota(order_.begin(), order_.end(), 0);
    std::sort(order_.begin(), order_.end(),
              [&](Local a, Local b) { return positions[a][0] < positions[b][0]; });
  }

  /// Of the largest ball that touches the surface at v on the side of `normal` and has no vertex inside, at
  /// most `most`; of vertices whose direction from v has a cosine above `cone` with the normal.
  double radius_at(Local v, const Vec3& normal, double most, double cone) const {
    const Vec3& p = positions_[v];
    const auto from = std::lower_bound(order_.begin(), order_.end(), p[0] - 2 * most,
                                       [&](Local w, double x) { return positions_[w][0] < x; });
    double radius = most;
    for (auto w = from; w != order_.end() && positions_[*w][0] <= p[0] + 2 * most; ++w) {
      const Vec3 apart = positions_[*w] - p;
      if (const double deep = apart.dot(normal); deep > cone * apart.norm())
        radius = std::min(radius, radius_of_ball(apart, normal));
    }
    return radius;
  }

private:
  std::span<const Vec3> positions_;
  std::vector<Local> order_;
};

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
  std::vector<Vec3> ways(positions.size(), Vec3::Zero());
  for (Local v = 0; v < Local(ways.size()); ++v) {
    const double missing = 0.5 * room - vertices.radius_at(v, normals[v], 0.5 * room, all_around);
    if (missing > 0)
      ways[v] = -std::min(missing, vertices.radius_at(v, -normals[v], room, opposite)) * normals[v];
  }
  const std::vector<Vec3> asked = ways;
  even_out(ways, triangles, few_rounds);
  keep_at_least(ways, asked);
  return ways;
}

} // namespace taut
