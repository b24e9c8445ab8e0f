#pragma once
#include "src/forces/force.hpp"

namespace taut {

/// Twist of quads, which neither the curvature of yarns nor that over edges sees. The vector w_uv = sum c x
/// is the mixed derivative of the bilinear cell, of which cloth that keeps its lengths has only the part
/// along the normal: w_u . w_uv = w_v . w_uv = 0. The energy T |w_uv|^2 A with the twist stiffness T (N m)
/// and the area A of the cell is that of a plate: B/2 (p^2 + q^2 + 2 s^2) per area with the curvatures p, q
/// and the twist s has T = B [Timoshenko, Woinowsky-Krieger 1959, section 11, Poisson ratio 0]. Quadratic in
/// the positions; the rest shape is flat.
///
/// The weights of the corners are those with which the rest shape, and all that is linear in it, gives zero:
/// +-(area of the triangle of the other three) in turn, of mean 1 / (l_u l_v), l_u and l_v the mean lengths
/// of opposite sides.
class Twist : public Force {
public:
  /// `cloth` and `pattern` must outlive the force. `damping` is the stiffness-proportional damping in s;
  /// sections without a stiffness are left out.
  Twist(const Cloth& cloth, const Pattern& pattern, const PerSection<double>& stiffness,
        const PerPiece<double>& damping);

  std::string_view name() const override { return "twist"; }
  double energy(const State& state) const override;
  void add_to(StepSystem& system, const State& state) override;

private:
  struct Stencil {
    std::array<Local, 4> vertices;
    std::array<double, 4> weights; ///< E = 1/2 |sum w x|^2
    Pattern::Slots<4> slots;

    Vec3 sum(std::span<const Vec3> x) const {
      return weights[0] * x[vertices[0]] + weights[1] * x[vertices[1]] + weights[2] * x[vertices[2]] +
             weights[3] * x[vertices[3]];
    }
  };

  const Cloth& cloth_;
  PerPiece<double> damping_;
  std::vector<Stencil> stencils_;
};

/// The weights c for which w_uv = sum c x. 0 for a quad without area.
std::array<double, 4> twist_weights(const std::array<Vec3, 4>& rest);

} // namespace taut
