#pragma once
#include "src/filters/edge_sweeps.hpp"
#include "src/forces/force.hpp"
#include "src/state/pins.hpp"

#include <memory>

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
class Xpbd {
public:
  /// All references must outlive it. Collective.
  Xpbd(const Cloth& cloth, const Pattern& pattern, const std::vector<std::unique_ptr<Force>>& forces,
       const Pins& pins, const config::Inextensibility& options);

  /// A step over `dt` from `start`. `freedom` is that of its last substep. Collective over neighbours.
  void advance(const State& start, double dt, Freedom& freedom, Candidate& candidate);

  int substeps() const { return substeps_; }

private:
  void substep(double h, Freedom& freedom);
  void fall(double h, const Freedom& freedom);
  void note_reaction(double h, const Freedom& freedom);
  Vec3 pull_of_edges(Local vertex, double h) const;

  const Cloth& cloth_;
  const std::vector<std::unique_ptr<Force>>& forces_;
  const Pins& pins_;
  int substeps_;
  double compliance_;
  EdgeSweeps sweeps_;
  StepSystem loads_;
  State now_;
  std::vector<Vec3> impulse_, x_, start_velocities_, pin_impulse_;
  std::vector<double> s_;
};

} // namespace taut
