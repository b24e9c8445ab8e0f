#pragma once
#include "src/forces/hinge_stencil.hpp"

namespace taut {

/// Isometric bending over edges [Bergou et al. 2006]: E = sum B/2 |K x|^2 / A, quadratic in the positions, so
/// its stiffness never changes; right for cloth that keeps its lengths and is flat at rest. (The paper's E =
/// k/2 sum x' Q x with Q = 3/A K'K is this for k = B/3: its energy of a cylinder is 3 times k/2 kappa^2.)
class IsometricBending : public Force {
public:
  /// `cloth` and `pattern` must outlive the force; `damping` is the stiffness-proportional damping in s.
  IsometricBending(const Cloth& cloth, const Pattern& pattern, std::span<const HingeStencil> folds,
                   const PerPiece<double>& damping);

  std::string_view name() const override { return "bending"; }
  double energy(const State& state) const override;
  void add_to(StepSystem& system, const State& state) override;

private:
  template<std::size_t n>
  struct Stencil {
    std::array<Local, n> vertices;
    std::array<double, n> weights; ///< E = 1/2 |sum w x|^2
    Pattern::Slots<n> slots;
    double damping;

    Vec3 sum(std::span<const Vec3> x) const {
      Vec3 sum = Vec3::Zero();
      for (std::size_t k = 0; k < n; ++k) sum += weights[k] * x[vertices[k]];
      return sum;
    }
  };
  template<class Visit>
  void for_each(Visit&& visit) const;

  const Cloth& cloth_;
  std::vector<Stencil<4>> narrow_; ///< between triangles
  std::vector<Stencil<6>> wide_;   ///< beside a quad
};

} // namespace taut
