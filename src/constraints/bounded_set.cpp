#include "src/constraints/bounded_set.hpp"

#include "src/constraints/solve_matrix_free.hpp"

#include <algorithm>

namespace taut {

template<ConstraintSet Set>
void BoundedSet<Set>::start(const State& start, double dt, const Freedom& freedom,
                            const Candidate& candidate) {
  set_.start(start, dt, freedom, candidate);
  bounds_.start(start.positions, set_.inverse_mass(), set_.freedom());
}

template<ConstraintSet Set>
double BoundedSet<Set>::evaluate(std::span<const Vec3> x) {
  const double of_set = set_.evaluate(x), of_bounds = limit_ * bounds_.evaluate(x, of_set / limit_);
  const auto first = set_.program_compliance(), rest = bounds_.compliance();
  compliance_.assign(first.begin(), first.end());
  compliance_.insert(compliance_.end(), rest.begin(), rest.end());
  return std::max(of_set, of_bounds);
}

template<ConstraintSet Set>
double BoundedSet<Set>::strain(std::span<const Vec3> x) const {
  return std::max(set_.strain(x), limit_ * bounds_.strain(x));
}

template<ConstraintSet Set>
SolveReport BoundedSet<Set>::solve(double tolerance) {
  if (bounds_.any()) return solve_matrix_free(cloth_.mesh, *this, tolerance);
  bounds_.add({});
  return set_.solve(tolerance);
}

template<ConstraintSet Set>
void BoundedSet<Set>::program_residual(std::span<double> residual) const {
  set_.program_residual(parts().of_first(residual));
  bounds_.program_residual(parts().of_second(residual));
}

template<ConstraintSet Set>
void BoundedSet<Set>::program_tolerance(double part_of_limit, std::span<double> tolerance) const {
  set_.program_tolerance(part_of_limit, parts().of_first(tolerance));
  bounds_.program_tolerance(part_of_limit, parts().of_second(tolerance));
}

template<ConstraintSet Set>
void BoundedSet<Set>::program_guess(std::span<double> guess) const {
  set_.program_guess(parts().of_first(guess));
  std::ranges::fill(parts().of_second(guess), 0.0);
}

template<ConstraintSet Set>
void BoundedSet<Set>::residual(std::span<double> rows) const {
  set_.residual(parts().of_first(rows));
  bounds_.residual(parts().of_second(rows));
}

template<ConstraintSet Set>
void BoundedSet<Set>::factor(std::span<const double> metric) {
  set_.factor(metric);
  bounds_.factor(metric);
}

template<ConstraintSet Set>
void BoundedSet<Set>::precondition(std::span<const double> r, std::span<double> s) const {
  set_.precondition(parts().of_first(r), parts().of_first(s));
  bounds_.precondition(parts().of_second(r), parts().of_second(s));
}

template<ConstraintSet Set>
void BoundedSet<Set>::begin_spread(std::span<const double> z) {
  set_.begin_spread(parts().of_first(z));
  multiplier_ = parts().of_second(z);
}

template<ConstraintSet Set>
void BoundedSet<Set>::end_spread(std::span<Vec3> field) {
  set_.end_spread(field);
  bounds_.spread(multiplier_, field);
}

template<ConstraintSet Set>
void BoundedSet<Set>::subtract_difference(std::span<const Vec3> u, std::span<double> rows) {
  set_.subtract_difference(u, parts().of_first(rows));
  bounds_.subtract_difference(u, parts().of_second(rows));
}

template<ConstraintSet Set>
void BoundedSet<Set>::add(std::span<const double> z) {
  set_.add(parts().of_first(z));
  bounds_.add(parts().of_second(z));
}

template class BoundedSet<MetricSet>;
template class BoundedSet<MixedSet>;

} // namespace taut
