#include "src/linear/krylov.hpp"

#include "partition/error.hpp"

namespace taut {

LinearSolver::LinearSolver(MPI_Comm comm, const char* name, const SolverOptions& options,
                           const char* preconditioner) {
  const std::string prefix = std::string(name) + "_";
  check(KSPCreate(comm, ksp_.address()));
  check(KSPSetOptionsPrefix(ksp_, prefix.c_str()));
  PC pc = nullptr;
  check(KSPGetPC(ksp_, &pc));
  if (options.kind == SolverOptions::Kind::mumps) {
    check(KSPSetType(ksp_, KSPPREONLY));
    check(PCSetType(pc, options.matrix == SolverOptions::Matrix::nonsymmetric ? PCLU : PCCHOLESKY));
    check(PCFactorSetMatSolverType(pc, MATSOLVERMUMPS));
  } else if (options.matrix == SolverOptions::Matrix::nonsymmetric) {
    check(KSPSetType(ksp_, KSPGMRES));
    check(KSPSetPCSide(ksp_, PC_RIGHT)); // so that the norm is that of the residual itself
    check(PCSetType(pc, preconditioner));
  } else {
    check(KSPSetType(ksp_, KSPCG));
    check(KSPSetNormType(ksp_, KSP_NORM_NATURAL)); // no reduction beyond the two of CG itself
    check(PCSetType(pc, preconditioner));
  }
  // A zero right-hand side is solved by zero: the absolute tolerance keeps PETSc from dividing by its norm.
  check(KSPSetTolerances(ksp_, PETSC_DEFAULT, 1e-300, PETSC_DEFAULT, options.max_iterations));
  try {
    check(KSPSetFromOptions(ksp_));
  } catch (const std::runtime_error& e) { // on all ranks: they read the same options
    throw InputError("the options -" + prefix + "...: " + e.what());
  }
  PetscBool given = PETSC_FALSE;
  check(PetscOptionsHasName(nullptr, prefix.c_str(), "-ksp_rtol", &given));
  tolerance_is_fixed_ = given;
}

SolveReport LinearSolver::solve(Vec rhs, Vec solution, double tolerance) {
  if (!tolerance_is_fixed_)
    check(KSPSetTolerances(ksp_, tolerance, PETSC_DEFAULT, PETSC_DEFAULT, PETSC_DEFAULT));
  check(KSPSolve(ksp_, rhs, solution));
  PetscInt iterations = 0;
  KSPConvergedReason reason = KSP_CONVERGED_ITERATING;
  check(KSPGetIterationNumber(ksp_, &iterations));
  check(KSPGetConvergedReason(ksp_, &reason));
  SolveReport report{int(iterations), ""};
  if (reason <= 0) report.failure = KSPConvergedReasons[reason];
  return report;
}

} // namespace taut
