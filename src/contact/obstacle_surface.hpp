#pragma once
#include "src/contact/obstacles.hpp"

namespace taut {

/// Triangles that show obstacles in pictures: spheres and capsules as they are, planes as a square, each of
/// its own thickness. Nothing collides with them.
class ObstacleSurface {
public:
  /// Of obstacles at the start; `obstacles` must outlive it. Planes are `plane_size` (m) wide around their
  /// point.
  ObstacleSurface(const Obstacles& obstacles, double plane_size);

  bool empty() const { return faces_.empty(); }
  std::span<const std::array<Global, 3>> faces() const { return faces_; }
  std::span<const std::int32_t> bodies() const { return bodies_; } ///< of the faces
  std::vector<Vec3> at(double time) const;                         ///< vertices, m

private:
  /// A round shape about the segment from `a` to `b`; a sphere if they are the same.
  void add_round(const Vec3& a, const Vec3& b, double radius, int body);
  void add_plane(const Obstacles::Plane& plane, const Vec3& point, double size);
  Global add_vertex(const Vec3& x, int body, Local vertex = -1);
  void add_face(Global a, Global b, Global c);

  const Obstacles& obstacles_;
  std::vector<Vec3> start_;
  std::vector<int> body_of_;
  std::vector<Local> vertex_of_; ///< the vertex of the obstacles that it is, -1 for none
  std::vector<std::array<Global, 3>> faces_;
  std::vector<std::int32_t> bodies_;
};

} // namespace taut
