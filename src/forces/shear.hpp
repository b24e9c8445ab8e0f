#pragma once
#include "src/forces/force.hpp"

namespace taut {

/// The shear condition of a quad with warp and weft directions w_u = sum c_u x, w_v = sum c_v x (means of its
/// opposite edges over their rest lengths): C = w_u . w_v - rest, the cosine of the angle between the yarns
/// [BW98 section 4.3, on a quad].
struct QuadShearStencil {
  std::array<double, 4> c_u, c_v;
  double rest; ///< w_u . w_v in the rest shape
};

struct ShearValue {
  double condition;             ///< C
  std::array<Vec3, 4> gradient; ///< dC/dx
};

QuadShearStencil quad_shear_stencil(const std::array<Vec3, 4>& rest);
ShearValue evaluate(const QuadShearStencil& stencil, const std::array<Vec3, 4>& x);

/// Shear of quads: E = G A / 2 C^2 with the shear stiffness G (N/m) and the rest area A. Of the Hessian
/// G A (dC dC^T + C (c_u c_v^T + c_v c_u^T) (x) I), the negative half of the second term is left out: for C >
/// 0 that of (c_u - c_v), for C < 0 that of (c_u + c_v).
class QuadShear : public Force {
public:
  /// `cloth` and `pattern` must outlive the force. `damping` is the stiffness-proportional damping in s.
  QuadShear(const Cloth& cloth, const Pattern& pattern, double stiffness, double damping);

  std::string_view name() const override { return "shear"; }
  double energy(const State& state) const override;
  void add_to(StepSystem& system, const State& state) const override;

private:
  struct Element {
    std::array<Local, 4> vertices;
    QuadShearStencil stencil;
    double stiffness; ///< G A
    std::array<std::int32_t, 16> slots;
  };

  const Cloth& cloth_;
  double damping_;
  std::vector<Element> elements_;
};

} // namespace taut
