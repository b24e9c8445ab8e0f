#pragma once
// What the two linear solvers share; for the .cpp files of this folder only.
#include "src/linear/petsc.hpp"
#include "src/linear/solver_options.hpp"

namespace taut {

/// A KSP with the prefix `-<name>_`: CG in the natural norm with PCType `preconditioner`, or MUMPS; then whatever the
/// PETSc options say. Collective.
OwnedKsp make_ksp(MPI_Comm comm, const char* name, const SolverOptions& options, const char* preconditioner);

/// Solves to the relative tolerance given (ignored by a direct solver), starting from zero. Collective.
SolveReport solve(KSP ksp, Vec rhs, Vec solution, double tolerance, int max_iterations);

} // namespace taut
