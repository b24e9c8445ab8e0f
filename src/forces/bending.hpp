#pragma once
#include "src/forces/force.hpp"

namespace taut {

/// Which threads bend: all yarns, or only chains of line elements.
enum class Threads { all, lines };

/// Isometric bending along yarns. At every vertex a yarn passes through, with neighbours b and a at rest
/// distances l1 and l2, the curvature vector is kappa = 2/(l1 + l2) ((x_a - x)/l2 - (x - x_b)/l1) and the
/// energy B/2 |kappa|^2 A with the bending stiffness B (N m) and the area A of the vertex: quadratic in the
/// positions, exact for a sheet bent without stretch [Bergou et al. 2006, Wardetzky et al. 2007, for the
/// stencil of a yarn]. The rest shape is flat.
class YarnBending : public Force {
public:
  /// `cloth` and `pattern` must outlive the force. `damping` is the stiffness-proportional damping in s;
  /// pieces without a stiffness are left out.
  YarnBending(const Cloth& cloth, const Pattern& pattern, Threads threads, const PerPiece<double>& stiffness,
              const PerPiece<double>& damping);

  std::string_view name() const override { return name_; }
  double energy(const State& state) const override;
  void add_to(StepSystem& system, const State& state) override;

private:
  /// What else it is made of is made again when it is needed: that takes less time than to read it.
  struct Stencil {
    Local triple; ///< of the mesh
    Pattern::Slots<3> slots;
  };

  std::array<double, 3> weights_of(const std::array<Local, 3>& triple) const; ///< E = 1/2 |sum w x|^2

  std::string_view name_;
  const Cloth& cloth_;
  PerPiece<double> stiffness_, damping_;
  std::vector<Stencil> stencils_;
};

/// The weights w for which kappa = sum w x, at rest distances l1 and l2.
std::array<double, 3> curvature_weights(double l1, double l2);

} // namespace taut
