#pragma once
#include "src/config/case.hpp"
#include "src/linear/solver_options.hpp"

#include <algorithm>

namespace taut {

/// How `inextensibility.solver` solves the linear systems of a projection, or of Newton's method.
inline SolverOptions solver_options(const config::Inextensibility& options) {
  using Kind = SolverOptions::Kind;
  return {options.solver == config::LinearSolver::mumps ? Kind::mumps : Kind::cg, 1000};
}

/// How tightly an iteration is solved: no tighter than what is left to do asks for (inexact Newton).
inline double forcing(double strain, double limit) { return std::clamp(0.1 * limit / strain, 1e-4, 1e-2); }

} // namespace taut
