#pragma once
#include "src/forces/folds.hpp"

namespace taut {

/// Isometric bending over edges [Bergou et al. 2006]: E = sum B/2 |K x|^2 / A, quadratic in the positions, so
/// its stiffness never changes; right for cloth that keeps its lengths and is flat at rest. On triangles z =
/// K x / A (see folds_of). (The paper's E = k/2 sum x' Q x with Q = 3/A K'K is this for k = B/3: its energy
/// of a cylinder is 3 times k/2 kappa^2.)
class IsometricBending : public Force {
public:
  /// `cloth` and `pattern` must outlive the force; `damping` is the stiffness-proportional damping in s.
  IsometricBending(const Cloth& cloth, const Pattern& pattern, const Folds& folds,
                   const PerPiece<double>& damping);

  std::string_view name() const override { return "bending"; }
  double energy(const State& state) const override;
  void add_to(StepSystem& system, const State& state) override;

private:
  /// E = 1/2 sum_r |sum_k weights[r][k] x_k|^2
  template<std::size_t n, std::size_t rows>
  struct Stencil {
    std::array<Local, n> vertices;
    std::array<std::array<double, n>, rows> weights;
    Pattern::Slots<n> slots;
    double damping;

    Vec3 sum(std::size_t row, std::span<const Vec3> x) const {
      Vec3 sum = Vec3::Zero();
      for (std::size_t k = 0; k < n; ++k) sum += weights[row][k] * x[vertices[k]];
      return sum;
    }
  };
  template<class Visit>
  void for_each(Visit&& visit) const;
  void add_hinge(const HingeStencil& fold, const Pattern& pattern, double damping);
  void add_triangle(const TriangleStencil& triangle, const Folds& folds, const Pattern& pattern,
                    double damping);

  const Cloth& cloth_;
  std::vector<Stencil<6, 3>> triangles_;
  std::vector<Stencil<4, 1>> narrow_; ///< folds between triangles, where a quad is near
  std::vector<Stencil<6, 1>> wide_;   ///< folds beside a quad
};

} // namespace taut
