#include "src/contact/closest.hpp"
#include "src/contact/obstacles.hpp"

/// Where places are, seen from obstacles.
namespace taut {

double Obstacles::distance_to(const Element& e, const Vec3& place, std::span<const Vec3> positions) const {
  const Vec3 &a = positions[e.vertices[0]], &b = positions[e.vertices[e.corners > 1 ? 1 : 0]];
  const double distance = e.is_triangle()
                              ? closest_vertex_face({place, a, b, positions[e.vertices[2]]}).distance
                              : closest_edge_edge({place, place, a, b}).distance;
  return distance - bodies_[e.body].radius;
}

double Obstacles::distance_to(const Plane& plane, const Vec3& place, std::span<const Vec3> positions) const {
  return plane.normal.dot(place - positions[plane.point]) - bodies_[plane.body].radius;
}

Obstacles::Nearest Obstacles::nearest(const Vec3& place, std::span<const Vec3> positions) const {
  Nearest nearest;
  const auto meet = [&](int body, double distance) {
    if (distance < nearest.distance) nearest = {body, distance};
  };
  for (const Plane& plane : planes_) meet(plane.body, distance_to(plane, place, positions));
  for (const Element& e : elements_) meet(e.body, distance_to(e, place, positions));
  return nearest;
}

/// From the frame of a triangle: its middle, its first side and its normal.
Eigen::Affine3d Obstacles::frame_of(Local element, double time) const {
  std::array<Vec3, 3> x;
  for (int k = 0; k < 3; ++k) x[k] = place_of(elements_[element].vertices[k], time);
  const Vec3 along = (x[1] - x[0]).normalized(), normal = along.cross(x[2] - x[0]).normalized();
  Eigen::Affine3d frame;
  frame.linear() << along, normal.cross(along), normal;
  frame.translation() = (x[0] + x[1] + x[2]) / 3;
  return frame;
}

Obstacles::Anchor Obstacles::anchor(int body, const Vec3& place) const {
  if (!frames_.contains(body)) {
    const Vec3 origin = moved(body, Vec3::Zero(), 0);
    Mat3 turn;
    for (int k = 0; k < 3; ++k) turn.col(k) = moved(body, Vec3::Unit(k), 0) - origin;
    return {body, -1, turn.transpose() * (place - origin)};
  }
  std::vector<Vec3> positions;
  this->place(0, positions);
  Local nearest = -1;
  double least = HUGE_VAL;
  for (Local k = 0; k < Local(elements_.size()); ++k)
    if (elements_[k].body == body)
      if (const double d = distance_to(elements_[k], place, positions); d < least) {
        least = d;
        nearest = k;
      }
  return {body, nearest, frame_of(nearest, 0).inverse(Eigen::Isometry) * place};
}

Vec3 Obstacles::follow(const Anchor& anchor, double time) const {
  return anchor.element < 0 ? moved(anchor.body, anchor.in_frame, time)
                            : frame_of(anchor.element, time) * anchor.in_frame;
}

} // namespace taut
