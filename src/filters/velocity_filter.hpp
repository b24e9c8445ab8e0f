#pragma once
#include "src/filters/step_report.hpp"
#include "src/state/freedom.hpp"
#include "src/state/state.hpp"

namespace taut {

using FilterReport = StepReport; ///< of one filter

/// Changes the velocities a step proposes so that a constraint holds at its end [G07 section 4: time
/// stepping, inextensibility and contact stay decoupled]. Filters form a list; each sees what those before it
/// left.
class VelocityFilter {
public:
  virtual ~VelocityFilter() = default;

  /// Velocities must stay in the directions that `freedom` denies. Ghosts are current on entry and on exit.
  /// Collective.
  virtual FilterReport apply(const State& start, double dt, const Freedom& freedom, Candidate& candidate) = 0;
};

} // namespace taut
