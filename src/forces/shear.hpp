#pragma once
#include "src/forces/force.hpp"

namespace taut {

/// The shear condition of a face with warp and weft directions w_u = sum c_u x, w_v = sum c_v x: C = w_u .
/// w_v - rest, the cosine of the angle between the yarns [BW98 section 4.3]. On a quad, w_u and w_v are the
/// means of its opposite sides over their rest lengths.
struct ShearStencil {
  std::array<double, 4> c_u, c_v; ///< 1/m; the fourth is 0 on a triangle
  double rest;                    ///< w_u . w_v in the rest shape
};

struct ShearValue {
  double condition;             ///< C
  std::array<Vec3, 4> gradient; ///< dC/dx
};

ShearStencil quad_shear_stencil(const std::array<Vec3, 4>& rest);
ShearStencil triangle_shear_stencil(const Corners2& material_coordinates);
ShearValue evaluate(const ShearStencil& stencil, const std::array<Vec3, 4>& x);

/// Shear of faces: E = G A / 2 C^2 with the shear stiffness G (N/m) and the rest area A; on triangles this is
/// BW98's condition with sqrt(A) in the place of A, which keeps its stiffness on a finer mesh. Of the Hessian
/// G A (dC dC^T + C (c_u c_v^T + c_v c_u^T) (x) I), the negative half of the second term is left out: for C >
/// 0 that of (c_u - c_v), for C < 0 that of (c_u + c_v).
///
/// Damping is d = -k_d dC Cdot with k_d = damping times G A [BW98 section 4.5]. Of its derivative by
/// positions the half of Cdot (c_u c_v^T + c_v c_u^T) (x) I that is positive together with the term above is
/// kept; dC (dCdot/dx)^T is left out, as in the paper, for it is not symmetric.
class Shear : public Force {
public:
  /// `cloth` and `pattern` must outlive the force. `damping` is the stiffness-proportional damping in s;
  /// sections without a stiffness are left out.
  Shear(const Cloth& cloth, const Pattern& pattern, const PerSection<double>& stiffness,
        const PerPiece<double>& damping);

  std::string_view name() const override { return "shear"; }
  double energy(const State& state) const override;
  void add_to(StepSystem& system, const State& state) override;

private:
  /// What else it is made of is made again when it is needed: that takes less time than to read it.
  struct Element {
    Local cell; ///< of the mesh
    Pattern::Slots<4> slots;
  };
  struct Face {
    std::array<Local, 4> vertices; ///< of a triangle, the first one again
    ShearStencil stencil;
    double stiffness; ///< G A
    double damping;   ///< s
  };

  Face face(Local cell) const;

  const Cloth& cloth_;
  PerSection<double> stiffness_;
  PerPiece<double> damping_;
  std::vector<Element> elements_;
};

} // namespace taut
