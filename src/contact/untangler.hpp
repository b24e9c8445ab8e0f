#pragma once
#include "src/contact/contact_search.hpp"
#include "src/contact/thickness.hpp"

#include <map>
#include <optional>
#include <tuple>

namespace taut {

/// How cloth that starts in a shallow overlap gets out of it, by small moves.
///
/// Where surfaces cross, they do so along curves. Of a segment of such a curve from P to Q, P is where an
/// edge along E goes through a face with the normal N; if the edge moves by D against the face, P moves in
/// the face by D - (D . N)/(E . N) E, and the segment becomes shorter by R . (D - (D . N)/(E . N) E) with R =
/// (Q - P)/|Q - P|. So the edge moves along R - (E . R)/(E . N) N and the face the other way: the curve
/// shrinks and is gone [Volino and Magnenat-Thalmann 2006]. That knows nothing of inside and outside, and
/// works for open surfaces.
///
/// Out of a closed mesh, whose walls may be steep, what of the cloth's vertices and edges is inside goes to
/// the nearest place of its surface; out of spheres, capsules and half-spaces, and of the thickness around
/// meshes, along the normal.
class Untangler {
public:
  /// All must outlive it. Collective.
  Untangler(const Cloth& cloth, const Obstacles& obstacles, const Thickness& thickness);

  /// A move of each owned vertex, m, from the positions given (cloth: local vertices, ghosts current): at
  /// most half the thickness where surfaces cross. Collective.
  std::vector<Vec3> find(std::span<const Vec3> cloth, std::span<const Vec3> obstacles);

private:
  /// Where an edge of an element goes through a face, and what shares that place.
  struct Piercing {
    std::array<Local, 5> vertices; ///< of the edge, then of the face
    std::array<double, 5> weights; ///< of a move: those of the face are negative
    Vec3 place, edge, normal;      ///< m; of length 1
  };
  /// What pushes a vertex, at its owner.
  struct Push {
    Local place;
    double weight;
    Vec3 direction;
  };

  /// A place on the cloth.
  struct Place {
    std::array<Local, 3> vertices;
    Vec3 weights; ///< of the vertices, with the sum 1
    int body;     ///< whose surface is crossed near it
  };
  /// The places where the surface of a body and a triangle pierce one another.
  struct Crossing {
    Vec3 weights = Vec3::Zero(); ///< barycentric, summed
    int count = 0;
  };
  using Edge = std::tuple<int, Local, Local>; ///< body, lower and higher number of the ends

  std::optional<Piercing> pierce(Local from, Local to, const Element& face) const;
  void shorten(const Element& a, const Element& b);
  void push(const Piercing& at, const Vec3& towards);
  void note(const Element& cloth, int body, std::span<const Piercing> places);
  std::vector<Place> places_within() const;
  bool is_inside(const Vec3& x, int body, std::span<const Vec3> obstacles) const;
  Vec3 to_surface(const Vec3& x, int body, std::span<const Vec3> obstacles) const;
  std::vector<Vec3> moves_along_curves();
  bool leave_solids(std::span<const Vec3> obstacles, std::vector<Vec3>& moves);
  void leave_bodies(std::span<const Vec3> cloth, std::span<const Vec3> obstacles, bool crosses,
                    std::vector<Vec3>& moves);

  const Cloth& cloth_;
  const Obstacles& obstacles_;
  const Thickness& thickness_;
  ElementSearch elements_;
  ContactSearch search_;
  std::vector<char> has_faces_;                 ///< of bodies
  std::map<Edge, std::vector<double>> pierced_; ///< edges of the cloth: where surfaces of closed meshes are
  std::map<std::pair<int, std::array<Local, 3>>, Crossing> crossed_; ///< the same of triangles
  std::vector<Push> pushes_;
  std::vector<int> owners_; ///< of the vertices they push
};

} // namespace taut
