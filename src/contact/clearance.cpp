#include "src/contact/clearance.hpp"

namespace taut {

std::vector<double> Clearance::measure(std::span<const Vec3> places, double time) {
  std::vector<Vec3> bodies;
  obstacles_.place(time, bodies);
  if (bodies != bodies_) {
    bodies_ = std::move(bodies);
    std::vector<Box> boxes;
    for (const Element& e : obstacles_.elements()) {
      Box& box = boxes.emplace_back();
      for (int k = 0; k < e.corners; ++k) box.include(bodies_[e.vertices[k]]);
      box.inflate(obstacles_.body(e.body).radius);
    }
    tree_.build(std::move(boxes));
  }
  std::vector<double> distances;
  for (const Vec3& place : places) {
    double least = tree_
                       .nearest(place,
                                [&](Local k) {
                                  return obstacles_.distance_to(obstacles_.elements()[k], place, bodies_);
                                })
                       .second;
    for (const Obstacles::Plane& plane : obstacles_.planes())
      least = std::min(least, obstacles_.distance_to(plane, place, bodies_));
    distances.push_back(least);
  }
  return distances;
}

} // namespace taut
