#pragma once
#include "src/filters/edge_sweeps.hpp"
#include "src/time/stepper.hpp"
#include "src/time/stepper_parts.hpp"

namespace taut {

/// XPBD with small substeps [Macklin et al. 2019]: a time stepping of its own. A step is cut into equal
/// substeps; in each, all forces act explicitly, one Gauss-Seidel sweep over the edges corrects the
/// positions, and the velocities follow from these:
///
///     v <- v + h f(x, v)/m,  x' = sweep(x + h v),  v <- (x' - x)/h.
///
/// No linear system is solved, no strain promised: it falls with the substeps, about as their square. Forces
/// limit the substep as explicit ones do. The tension of an edge, and the force of a pin, is
/// the mean over the substeps.
class Xpbd : public Stepper {
public:
  /// Collective.
  explicit Xpbd(const StepperParts& parts);

  StepReport propose(const State& state, double dt, Candidate& candidate) override;

private:
  void substep(double h);
  void fall(double h);
  void note_reaction(double h);
  Vec3 pull_of_edges(Local vertex, double h) const;

  const Cloth& cloth_;
  const Forces& forces_;
  const Pins& pins_;
  int substeps_;
  double compliance_;
  EdgeSweeps sweeps_;
  StepSystem loads_;
  State now_;
  Freedom freedom_; ///< of the present substep
  std::vector<Vec3> impulse_, x_, start_velocities_, pin_impulse_;
  std::vector<double> s_;
};

} // namespace taut
