#pragma once
#include "src/forces/force.hpp"

namespace taut {

/// Stiff springs in place of constraints, on the same edges: E = K l/2 e^2 with the strain e = |d|/l - 1 and
/// the stiffness K, the tension at e = 1, in N. Of the Hessian K/l (n n^T + (1 - l/|d|) (I - n n^T)), n =
/// d/|d|, the second term is left out while the spring is compressed. One linearisation a step [BW98 eq. 6]:
/// how far an edge stretches follows from K and the step, and no limit is kept.
class Springs : public Force {
public:
  /// `cloth` and `pattern` must outlive the force. `damping` is the stiffness-proportional damping in s.
  Springs(const Cloth& cloth, const Pattern& pattern, double stiffness, const PerPiece<double>& damping);

  std::string_view name() const override { return "springs"; }
  double energy(const State& state) const override;
  void add_to(StepSystem& system, const State& state) override;

private:
  struct Element {
    Local edge;
    Pattern::Slots<2> slots;
    double damping; ///< s
  };

  const Cloth& cloth_;
  double stiffness_;
  std::vector<Element> elements_; ///< edges with an end of this rank, in original order
};

} // namespace taut
