#include "src/linear/krylov.hpp"

namespace taut {

OwnedKsp make_ksp(MPI_Comm comm, const char* name, const SolverOptions& options, const char* preconditioner) {
  OwnedKsp ksp;
  check(KSPCreate(comm, ksp.address()));
  check(KSPSetOptionsPrefix(ksp, (std::string(name) + "_").c_str()));
  PC pc = nullptr;
  check(KSPGetPC(ksp, &pc));
  if (options.kind == SolverOptions::Kind::mumps) {
    check(KSPSetType(ksp, KSPPREONLY));
    check(PCSetType(pc, PCCHOLESKY));
    check(PCFactorSetMatSolverType(pc, MATSOLVERMUMPS));
  } else {
    check(KSPSetType(ksp, KSPCG));
    check(KSPSetNormType(ksp, KSP_NORM_NATURAL)); // no reduction beyond the two of CG itself
    check(PCSetType(pc, preconditioner));
  }
  check(KSPSetErrorIfNotConverged(ksp, PETSC_FALSE));
  check(KSPSetTolerances(ksp, PETSC_DEFAULT, PETSC_DEFAULT, PETSC_DEFAULT, options.max_iterations));
  check(KSPSetFromOptions(ksp));
  return ksp;
}

SolveReport solve(KSP ksp, Vec rhs, Vec solution, double tolerance, int max_iterations) {
  // A zero right-hand side is solved by zero; PETSc would divide by its norm.
  check(KSPSetTolerances(ksp, tolerance, 1e-300, PETSC_DEFAULT, max_iterations));
  check(KSPSolve(ksp, rhs, solution));
  PetscInt iterations = 0;
  KSPConvergedReason reason = KSP_CONVERGED_ITERATING;
  check(KSPGetIterationNumber(ksp, &iterations));
  check(KSPGetConvergedReason(ksp, &reason));
  SolveReport report{int(iterations), ""};
  if (reason <= 0) report.failure = KSPConvergedReasons[reason];
  return report;
}

} // namespace taut
