#pragma once
#include "src/config/case.hpp"
#include "src/contact/surface.hpp"

namespace taut {

/// The bodies that cloth collides with, held whole on every rank: planes, and points, segments and triangles
/// with a radius around them (a sphere is a point, a capsule a segment). Surfaces have two sides: which way a
/// mesh is oriented, and whether it is closed, does not matter.
class Obstacles {
public:
  /// Reads the meshes. Throws InputError for what is wrong with them. Collective.
  Obstacles(MPI_Comm comm, const Case& input);

  /// A half-space: cloth stays on the side `normal` points to.
  struct Plane {
    Local point; ///< a vertex that lies on it
    Vec3 normal; ///< of length 1
    int body;
  };

  struct Body {
    std::string name;
    double radius;   ///< m around its vertices, segments or triangles; the body's thickness is in it
    double friction; ///< Coulomb's coefficient against cloth
  };

  Local vertices() const { return Local(start_.size()); }
  std::span<const Element> elements() const { return elements_; }
  std::span<const Plane> planes() const { return planes_; }
  const Body& body(int k) const { return bodies_[k]; }
  bool empty() const { return bodies_.empty(); }

  std::span<const Vec3> start() const { return start_; } ///< of all vertices, as the case gives them; m

  /// Where a point of a body is at `time` that is at `start` in the case. m.
  Vec3 moved(int body, const Vec3& start, double time) const;

  /// Where all vertices are at `time`: turned and moved by the keyframes, linear between them. m.
  void place(double time, std::vector<Vec3>& positions) const;

private:
  void add(MPI_Comm comm, const Case& input, int body);
  Local add_vertex(int body, const Vec3& position);
  void add_triangles(std::span<const std::array<Local, 3>> triangles, int body);

  std::vector<config::Obstacle> inputs_;
  std::vector<Body> bodies_;
  std::vector<Vec3> start_;
  std::vector<int> body_of_;
  std::vector<Element> elements_;
  std::vector<Plane> planes_;
};

} // namespace taut
