#pragma once
#include "src/state/freedom.hpp"
#include "src/state/state.hpp"

#include <string>

namespace taut {

struct FilterReport {
  int iterations = 0;          ///< of the filter
  int linear_iterations = 0;   ///< of the linear solver, over all of them
  Global contacts = 0;         ///< features in reach of each other
  Global contacts_if_even = 0; ///< if every rank had as many as the one with most
  double contact_seconds = 0;  ///< spent on finding them and on moving without meeting them
  bool too_costly = false;     ///< two steps of half the length would have cost less, most likely
  std::string failure;         ///< empty, or why the step cannot be accepted
};

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
