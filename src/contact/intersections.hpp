#pragma once
#include "src/contact/element_search.hpp"

namespace taut {

/// An edge of the cloth through a face, a face of the cloth through an edge of an obstacle, or cloth inside a
/// sphere, a capsule or behind a plane.
struct Intersection {
  std::array<Global, 2> first, second; ///< two vertices of each (keys, see SurfaceVertex)
  Vec3 place;                          ///< m, a vertex of the first
  int body;                            ///< the obstacle, or -1: both are cloth
};

/// Looks for intersections at given positions by exact predicates (CGAL's), independently of how contact is
/// handled: nothing but the boxes of the search for elements is shared with it. Faces and edges that share a
/// vertex are not compared.
class Intersections {
public:
  /// Both must outlive it. Collective.
  Intersections(const Cloth& cloth, const Obstacles& obstacles);

  /// Those this rank found at the positions given (cloth: local vertices, ghosts current); each is found on
  /// one rank. Collective.
  std::vector<Intersection> find(std::span<const Vec3> cloth, std::span<const Vec3> obstacles);

private:
  void compare(const Element& a, const Element& b);
  void pierce(const Element& edges, const Element& face);
  void come_inside(const Element& cloth, const Element& body);
  void look_behind_planes();
  void add(Local first, Local first_end, const Element& second, int body);

  const Cloth& cloth_;
  const Obstacles& obstacles_;
  ElementSearch search_;
  std::vector<Intersection> found_;
};

} // namespace taut
