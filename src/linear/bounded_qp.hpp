#pragma once
#include "partition/comm.hpp"

#include <functional>

namespace taut {

/// Minimise 1/2 z'Az - b'z for lower <= z <= upper, entrywise, over all ranks; A symmetric positive
/// semi-definite. Every rank holds a part of z and of everything that goes with it.
struct BoundedQp {
  using Operator = std::function<void(std::span<const double>, std::span<double>)>;
  Operator multiply;     ///< A z; collective
  Operator precondition; ///< an approximate inverse of A; diagonal on entries that have a bound; collective
  std::span<const double> rhs;
  std::size_t unbounded;                ///< so many leading entries of this rank have no bounds
  std::span<const double> lower, upper; ///< of the entries behind them; may be infinite
  std::span<const double> tolerance;    ///< what the projected gradient may leave of each entry
};

/// When a program ends that is not solved. What conjugate gradients leave rises and falls from iteration to
/// iteration, so it pays to wait for a good moment.
struct QpEffort {
  int products;                 ///< fewest
  int most_products = products; ///< reached while an entry without bounds is not good enough
  double good_enough = 1;       ///< so many tolerances it may leave
};

struct QpReport {
  int products = 0;    ///< with A
  bool solved = false; ///< to the tolerance; otherwise the products ran out
};

/// Projected conjugate gradients. Every iteration takes the preconditioned gradient, without the entries that
/// would leave their bounds, made conjugate to the last displacement; steps along it, projects the result on
/// the bounds, and goes the best part of the way there, or all of it where that lowers the objective well
/// enough, so that entries arrive at their bounds. One product an iteration; the objective never rises;
/// while no bound is met it is the method of conjugate gradients. (MPRGP [Dostal, Schoeberl 2005], which
/// starts its conjugate gradients anew whenever a bound is met, needs about three times the products here.)
///
/// `z` is the result; its values on entry are where it starts. Collective.
QpReport solve(MPI_Comm comm, const BoundedQp& qp, const QpEffort& effort, std::vector<double>& z);

} // namespace taut
