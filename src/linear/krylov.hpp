#pragma once
// What the two linear solvers share; for the .cpp files of this folder only.
#include "src/linear/petsc.hpp"
#include "src/linear/solver_options.hpp"

namespace taut {

/// A linear solver with the prefix `-<name>_`: CG in the natural norm (GMRES for a matrix, or with the
/// preconditioner `grids`, that is not symmetric) with PCType `preconditioner`, or MUMPS; then whatever the
/// PETSc options say.
class LinearSolver {
public:
  /// Throws InputError for options that PETSc refuses. Collective.
  LinearSolver(MPI_Comm comm, const char* name, const SolverOptions& options, const char* preconditioner);

  /// Solves to the relative tolerance given (but `-<name>_ksp_rtol` has the last word, and a direct solver
  /// has none), starting from zero. The first solve, and every one if options chose the method, is verified
  /// by its true residual: throws InputError if that is no solution. Collective.
  SolveReport solve(Vec rhs, Vec solution, double tolerance);

  /// Of MUMPS on an indefinite matrix, before the first solve: pivots that it delays take memory which its
  /// analysis does not foresee. Collective.
  void leave_room_for_pivots();

  operator KSP() const { return ksp_; }

private:
  void verify(Vec rhs, Vec solution);

  std::string name_; ///< the prefix
  OwnedKsp ksp_;
  OwnedVec residual_; ///< made when it is first needed
  bool tolerance_is_fixed_ = false, method_is_chosen_ = false;
  bool verified_ = false; ///< some solve has been
};

} // namespace taut
