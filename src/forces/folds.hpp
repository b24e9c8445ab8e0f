#pragma once
#include "src/forces/hinge_stencil.hpp"

namespace taut {

/// The energy of a triangle by the curvatures z = |e| theta / A over its sides: E = 1/2 sum_r (sum_k
/// rows[r][k] z_k)^2, k its folds. See folds_of.
struct TriangleStencil {
  std::array<Local, 6> vertices;     ///< as of a TrianglePatch
  std::array<std::int32_t, 3> folds; ///< their places in Folds::hinges; -1 where the mesh ends
  std::array<std::array<int, 4>, 3>
      place; ///< of x0 .. x3 of each fold in `vertices`, the first if one is there twice
  std::array<std::array<double, 3>, 3> rows;
};

/// What resists folding.
struct Folds {
  std::vector<HingeStencil> hinges; ///< all; of stiffness 0 where triangles have taken it over
  std::vector<TriangleStencil> triangles;
};

/// Bending stiffness of warp and weft, and of twist, N m; and that of folds over seams, where it is larger:
/// the allowances of a seam lie double there.
struct Rigidity {
  double warp, weft, twist;
  double seam = 0;
};

/// All folds of the sections that have a rigidity; all of a piece have one, or none.
///
/// On quads, and triangles beside them, each fold is on its own, with B = (B_warp dv^2 + B_weft du^2) / (du^2
/// + dv^2) for an edge that runs by (du, dv) in the cloth: an edge along weft folds the warp threads [BW98
/// section 4.4, for meshes whose edges follow the threads]. The energy sum 1/2 B |e|^2 / A theta^2 of a mesh
/// bent to a cylinder along its edges is B / 2 kappa^2 times its area.
///
/// Of a triangle among triangles, the curvatures z over its three sides together tell those of the sheet, p
/// and q along warp and weft and the twist s, so that with D = diag(B_warp, B_weft, 2 T) it has the energy
/// A/2 (p, q, s) D (p, q, s) of an orthotropic plate. What the sides would store alone, each with its z^2, is
/// another plate (of Poisson ratio -1/3 on equilateral triangles), or none. There are two ways, of which
/// three quarters and one are taken:
/// - z = R (p, q, s) with R from the quadratic functions over the patch, so E = A/2 z^T (R D^-1 R^T)^-1 z:
///   right for every quadratic function on any mesh, but where a vertex has no mirror image it is pushed out
///   of it, and the sheet is too soft;
/// - k = sum z_e A_e / 2A n_e n_e^T [Onate and Cervera 1993, from the mean slopes over the sides]: no vertex
///   is pushed out of a constant curvature, but where triangles have no mirror image their energy is too
///   large.
/// Where each two neighbours are mirror images (any affine picture of equilateral triangles) both are the
/// plate. At a border, what is not told is what costs least. Eigenvalues of the first are bounded by those of
/// ordinary triangles, for six vertices on one conic do not tell curvatures apart.
Folds folds_of(const Cloth& cloth, const PerSection<Rigidity>& rigidity);

} // namespace taut
