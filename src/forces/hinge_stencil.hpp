#pragma once
#include "src/forces/force.hpp"

namespace taut {

/// Folding over an edge between two faces, seen as two triangles: the edge x0 -> x1 with the apexes x2 on its
/// left and x3 on its right. The apex of a triangle is its third vertex, that of a quad the middle of the
/// opposite side; so the heights of the apexes are those of the faces, and on a regular grid of quads a fold
/// sees the curvature of the threads across the edge.

/// The angle about x0 -> x1 by which the normal of the left triangle turns into that of the right one, in
/// (-pi, pi], 0 if flat, and its gradient. A triangle without area has no normal: the angle is then 0 with
/// gradient 0.
struct Dihedral {
  double angle;
  std::array<Vec3, 4> gradient;
};
Dihedral dihedral(const std::array<Vec3, 4>& x);

/// One fold of the mesh. Cotangents, areas and angle are those of the rest shape.
struct HingeStencil {
  std::array<Local, 6> vertices; ///< edge, left, right; unused places repeat the one before
  std::array<double, 6> weight;  ///< of each vertex in its corner: 1, or 1/2 and 1/2, or 1 and 0
  std::array<Vec3, 4> rest;      ///< x0 .. x3 at rest
  Vec2 run;                      ///< of the edge along warp and weft, of length one
  double area;                   ///< A = A_left + A_right of the two triangles, m^2
  double stiffness;              ///< J, of the angle; of faces that are no TriangleStencil

  int size() const { return vertices[3] != vertices[2] || vertices[5] != vertices[4] ? 6 : 4; }
  std::array<Vec3, 4> corners(std::span<const Vec3> x) const;
  double length() const { return (rest[1] - rest[0]).norm(); } ///< of the edge, m
  double area_of_side(int side) const;                         ///< A_left (0) or A_right (1)
};

/// Without a stiffness.
HingeStencil hinge_stencil(const DistributedMesh& mesh, const Hinge& hinge);

/// The row K of the isometric bending form [Bergou et al. 2006, section 3; Wardetzky et al. 2007]: |K x|^2 /
/// A = |e|^2 / A theta^2 for small angles at rest lengths, K x = sum K_i x_i.
std::array<double, 4> isometric_row(const std::array<Vec3, 4>& rest);

/// What adds a row over the four corners of a fold to its vertices.
template<class T>
std::array<T, 6> spread(const HingeStencil& f, const std::array<T, 4>& corner) {
  constexpr std::array<int, 6> corner_of{0, 1, 2, 2, 3, 3};
  std::array<T, 6> all;
  for (int k = 0; k < 6; ++k) all[k] = f.weight[k] * corner[corner_of[k]];
  return all;
}

} // namespace taut
