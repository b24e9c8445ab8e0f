#pragma once
#include "src/forces/force.hpp"

namespace taut {

/// Shear of quads by springs along their two diagonals: E = k/2 (|d| / L - 1)^2 for each, with rest length L
/// and k (J) such that a parallelogram sheared by a small angle g has the energy G A g^2 / 2: its diagonals
/// strain by A g / L^2, so k = G L^4 / (2 A). Unlike the condition of Shear, springs also resist stretch of
/// warp and weft. Of the Hessian k/L^2 n n^T + T/|d| (I - n n^T) with the direction n and the tension T, the
/// second term is left out under compression.
class DiagonalSprings : public Force {
public:
  /// `cloth` and `pattern` must outlive the force. `damping` is the stiffness-proportional damping in s,
  /// along the springs; sections without a stiffness are left out.
  DiagonalSprings(const Cloth& cloth, const Pattern& pattern, const PerSection<double>& stiffness,
                  const PerPiece<double>& damping);

  std::string_view name() const override { return "shear"; }
  double energy(const State& state) const override;
  void add_to(StepSystem& system, const State& state) override;

private:
  struct Spring {
    std::array<Local, 2> vertices;
    double length;    ///< L, m
    double stiffness; ///< k / L^2, N/m
    double damping;   ///< s
    Pattern::Slots<2> slots;
  };

  const Cloth& cloth_;
  std::vector<Spring> springs_;
};

} // namespace taut
