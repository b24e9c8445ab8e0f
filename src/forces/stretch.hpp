#pragma once
#include "src/forces/force.hpp"

namespace taut {

/// A direction of the cloth over a stencil: w = sum c x is its tangent, of length one at rest [BW98 section
/// 4.2]. Unused places repeat the first vertex with c = 0.
struct TangentStencil {
  std::array<Local, 3> vertices;
  std::array<double, 3> c; ///< 1/m
};

/// Coefficients of w_u and w_v of a triangle with the material coordinates `m` [BW98 eq. 9]:
/// w_u = ((x1 - x0) dv2 - (x2 - x0) dv1) / D, D twice the area.
std::array<std::array<double, 3>, 2> tangent_coefficients(const Corners2& m);

struct StretchMaterial {
  Vec2 stiffness = Vec2::Zero(); ///< of warp and weft, N/m; N on a line
  Vec2 target = Vec2::Ones();    ///< b_u, b_v [BW98 section 4.2]
  double damping = 0;            ///< stiffness-proportional, s
  double compression = 1;        ///< part of the stiffness that there is where |w| < b
};

/// Stretch of warp and weft [BW98 section 4.2]: E = k/2 C^2 with C = sqrt(a) (|w| - b), where a is the part
/// of the rest area on which w is the tangent. (The paper has a in the place of sqrt(a); then cloth grows
/// softer on a finer mesh.) On a triangle w_u and w_v are constant; on a quad they are taken on each of its
/// four sides, which are warp or weft threads, with half the area: its w_u at the centre alone would let a
/// quad change into a trapezoid for nothing. A line element is a warp thread with its length for an area.
///
/// Of the Hessian of C, sqrt(a) c c^T (x) (I - w w^T / |w|^2) / |w|, nothing is used where it is multiplied
/// with a negative number: under compression, and no more than k. Damping is d = -k_d dC Cdot with k_d =
/// damping times k [BW98 section 4.5]; of its derivative by positions, dC (dCdot/dx)^T is left out, as in the
/// paper, for it is not symmetric.
class Stretch : public Force {
public:
  /// `cloth` and `pattern` must outlive the force; sections without a material are left out.
  Stretch(const Cloth& cloth, const Pattern& pattern, const PerSection<StretchMaterial>& material);

  std::string_view name() const override { return "stretch"; }
  double energy(const State& state) const override;
  void add_to(StepSystem& system, const State& state) override;

private:
  struct Element {
    TangentStencil tangent;
    double stiffness; ///< k a
    double target;    ///< b
    double damping;   ///< s
    double compression;
    Pattern::Slots<3> slots;

    double stiffness_at(double length) const { return length < target ? compression * stiffness : stiffness; }
  };

  const Cloth& cloth_;
  std::vector<Element> elements_;
};

/// The tangents of all local cells, with the measure each stands for: those of a face in turn along warp and
/// weft.
struct Tangent {
  TangentStencil stencil;
  double measure; ///< m^2, m on a line
  int direction;  ///< 0 warp, 1 weft
  std::size_t cell;
};
std::vector<Tangent> tangents_of(const Cloth& cloth);

/// The same of one local cell, behind those that are there.
void append_tangents(const Cloth& cloth, std::size_t cell, std::vector<Tangent>& tangents);

inline Vec3 tangent(const TangentStencil& s, std::span<const Vec3> x) {
  return s.c[0] * x[s.vertices[0]] + s.c[1] * x[s.vertices[1]] + s.c[2] * x[s.vertices[2]];
}

/// Largest ||w| - 1|: the strain of faces, where the limit is for something else. Collective.
double largest_strain(const Cloth& cloth, std::span<const Tangent> tangents, std::span<const Vec3> positions);

/// Largest change of any |w| from one state to another: how drastically stretch changes in a step [BW98
/// section 6]. Collective.
double largest_stretch_change(const Cloth& cloth, std::span<const Tangent> tangents,
                              std::span<const Vec3> from, std::span<const Vec3> to);

} // namespace taut
