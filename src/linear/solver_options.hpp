#pragma once
#include <string>

namespace taut {

/// How a linear system is to be solved. PETSc options with the system's prefix change everything else.
struct SolverOptions {
  enum class Kind {
    cg,    ///< preconditioned conjugate gradients
    mumps, ///< distributed Cholesky factorisation
  };
  Kind kind = Kind::cg;
  int max_iterations = 1000;
};

struct SolveReport {
  int iterations = 0;
  std::string failure; ///< empty if the solver reached its tolerance; else PETSc's reason
};

} // namespace taut
