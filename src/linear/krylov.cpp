#include "src/linear/krylov.hpp"

#include "partition/error.hpp"

#include <fmt/format.h>

#include <array>
#include <string_view>

namespace taut {

namespace {

/// Of the right-hand side. CG stops by another norm, in which a thousandth can be many times as much in this.
constexpr double most_left = 0.9;

/// Of what a solve may leave, so that it is verified: where little is asked, as of the first corrections of a
/// projection, what CG leaves says nothing in that other norm.
constexpr double loose = 0.05;

/// Vectors of GMRES: few solves of velocities need more iterations.
constexpr PetscInt most_directions = 50;

/// What options say that the preconditioner is to be.
std::string preconditioner_in(const std::string& prefix, const char* by_default) {
  std::array<char, 64> name{};
  PetscBool given = PETSC_FALSE;
  check(PetscOptionsGetString(nullptr, prefix.c_str(), "-pc_type", name.data(), name.size(), &given));
  return given ? name.data() : by_default;
}

bool is_given(const std::string& prefix, const char* option) {
  PetscBool given = PETSC_FALSE;
  check(PetscOptionsHasName(nullptr, prefix.c_str(), option, &given));
  return given;
}

/// PETSc takes some values that mean something else to it, or end in no iteration at all.
void check_tolerances(KSP ksp, const std::string& prefix) {
  double relative = 0;
  PetscInt iterations = 0;
  check(KSPGetTolerances(ksp, &relative, nullptr, nullptr, &iterations));
  if (iterations < 1)
    throw InputError(
        fmt::format("the option -{}ksp_max_it: {} is less than 1, so that nothing would be solved; "
                    "give the most iterations there may be",
                    prefix, iterations));
  if (!(relative > 0 && relative < 1))
    throw InputError(fmt::format("the option -{}ksp_rtol: {:g} is not between 0 and 1", prefix, relative));
}

} // namespace

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
  } else if (options.matrix == SolverOptions::Matrix::nonsymmetric ||
             preconditioner_in(prefix, preconditioner) == "grids") {
    check(KSPSetType(ksp_, KSPGMRES));
    check(KSPGMRESSetRestart(ksp_, most_directions));
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
  check_tolerances(ksp_, prefix);
  tolerance_is_fixed_ = is_given(prefix, "-ksp_rtol");
  method_is_chosen_ = is_given(prefix, "-ksp_type") || is_given(prefix, "-pc_type");
  name_ = prefix;
}

SolveReport LinearSolver::solve(Vec rhs, Vec solution, double tolerance) {
  if (!tolerance_is_fixed_)
    check(KSPSetTolerances(ksp_, tolerance, PETSC_DEFAULT, PETSC_DEFAULT, PETSC_DEFAULT));
  try {
    check(KSPSolve(ksp_, rhs, solution));
  } catch (const std::runtime_error& e) { // on all ranks: what PETSc says to methods that do not go together
    if (!method_is_chosen_) throw;
    throw InputError(fmt::format("the options -{}...: {}", name_, e.what()));
  }
  PetscInt iterations = 0;
  KSPConvergedReason reason = KSP_CONVERGED_ITERATING;
  check(KSPGetIterationNumber(ksp_, &iterations));
  check(KSPGetConvergedReason(ksp_, &reason));
  SolveReport report{int(iterations), ""};
  if (reason <= 0) report.failure = KSPConvergedReasons[reason];
  if (reason > 0 && (method_is_chosen_ || (!verified_ && tolerance < loose))) verify(rhs, solution);
  return report;
}

void LinearSolver::leave_room_for_pivots() {
  constexpr PetscInt memory_relaxation = 14, percent = 300; // so many more
  PC pc = nullptr;
  Mat factor = nullptr;
  check(KSPGetPC(ksp_, &pc));
  MatSolverType package = nullptr; // options may have chosen another, or none
  check(PCFactorGetMatSolverType(pc, &package));
  if (!package || std::string_view(package) != MATSOLVERMUMPS) return;
  // PETSc names the factor when the solver is set up, after it was made here: too late for its options.
  Mat matrix = nullptr;
  check(PCGetOperators(pc, &matrix, nullptr));
  check(MatSetOptionsPrefixFactor(matrix, name_.c_str()));
  check(PCFactorSetUpMatSolverType(pc));
  check(PCFactorGetMatrix(pc, &factor));
  check(MatMumpsSetIcntl(factor, memory_relaxation, percent));
}

/// What calls itself converged may not have looked: preonly never does, nor does a test that options turn
/// off.
void LinearSolver::verify(Vec rhs, Vec solution) {
  double whole = 0, left = 0;
  check(VecNorm(rhs, NORM_2, &whole));
  if (whole == 0) return;
  Mat matrix = nullptr;
  check(KSPGetOperators(ksp_, &matrix, nullptr));
  if (!residual_) check(VecDuplicate(rhs, residual_.address()));
  check(MatMult(matrix, solution, residual_));
  check(VecAYPX(residual_, -1.0, rhs));
  check(VecNorm(residual_, NORM_2, &left));
  verified_ = true;
  if (left <= most_left * whole) return;
  throw InputError(
      fmt::format("the linear system of -{}...: a solve left {:.3g} of its right-hand side, measured anew, "
                  "and called that converged; choose other options if there are any; without, equations "
                  "contradict each other or repeat: a straight thread held at both ends needs a compliance",
                  name_, left / whole));
}

} // namespace taut
