#include "src/contact/normal_cones.hpp"

#include <boost/container/static_vector.hpp>

#include <algorithm>

namespace taut {

NormalCones::NormalCones(const Obstacles& obstacles) : neighbours_(obstacles.vertices()) {
  for (const Element& e : obstacles.elements())
    for (int k = 0; k < e.corners && e.corners > 1; ++k) {
      const Local a = e.vertices[k], b = e.edge_end(k);
      neighbours_[a].push_back(b);
      neighbours_[b].push_back(a);
      if (e.is_triangle())
        opposite_[{std::min(a, b), std::max(a, b)}].push_back(e.vertices[e.next(e.next(k))]);
    }
}

bool NormalCones::holds(const Pair& pair, const Approach& here, std::span<const Vec3> field, Local first,
                        double aslant) const {
  boost::container::static_vector<Local, 3> nearest; // of the obstacle's vertices, those in play
  Vec3 place = Vec3::Zero();
  double sum = 0;
  const Local end = first + Local(neighbours_.size());
  for (int i = 0; i < 4; ++i) {
    const Local v = pair.vertices[i];
    if (v < first || v >= end || here.weights[i] == 0) continue;
    nearest.push_back(v - first);
    place += here.weights[i] * field[v];
    sum += here.weights[i];
  }
  if (nearest.empty() || nearest.size() == 3) return true;
  place /= sum;
  const Vec3 outwards = sum < 0 ? here.normal : Vec3(-here.normal);
  const auto leads_outwards = [&](Local v) {
    const Vec3 inwards = field[first + v] - place;
    return outwards.dot(inwards) > aslant * inwards.norm();
  };
  if (nearest.size() == 1) return std::ranges::none_of(neighbours_[nearest[0]], leads_outwards);
  const auto corners = opposite_.find({std::min(nearest[0], nearest[1]), std::max(nearest[0], nearest[1])});
  return corners == opposite_.end() || std::ranges::none_of(corners->second, leads_outwards);
}

} // namespace taut
