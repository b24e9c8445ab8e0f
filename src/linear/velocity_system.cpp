#include "src/linear/velocity_system.hpp"

#include "src/linear/assembled.hpp"
#include "src/linear/filtered_operator.hpp"
#include "src/linear/krylov.hpp"

#include <algorithm>

namespace taut {

namespace {

static_assert(sizeof(Vec3) == 3 * sizeof(PetscScalar) && sizeof(Mat3) == 9 * sizeof(PetscScalar));

struct Context {
  FilteredOperator filtered;
  std::vector<Mat3> inverse_blocks;
};

Context& context_of(Mat shell) {
  void* context = nullptr;
  MatShellGetContext(shell, &context);
  return *static_cast<Context*>(context);
}

PetscErrorCode multiply(Mat shell, Vec x, Vec y) {
  PetscFunctionBegin;
  PetscInt n = 0;
  const PetscScalar* from = nullptr;
  PetscScalar* to = nullptr;
  PetscCall(VecGetLocalSize(x, &n));
  PetscCall(VecGetArrayRead(x, &from));
  PetscCall(VecGetArrayWrite(y, &to));
  context_of(shell).filtered.apply({reinterpret_cast<const Vec3*>(from), std::size_t(n / 3)},
                                   {reinterpret_cast<Vec3*>(to), std::size_t(n / 3)});
  PetscCall(VecRestoreArrayWrite(y, &to));
  PetscCall(VecRestoreArrayRead(x, &from));
  PetscFunctionReturn(0);
}

/// What PCPBJACOBI asks a matrix for.
PetscErrorCode invert_diagonal_blocks(Mat shell, const PetscScalar** values) {
  PetscFunctionBegin;
  Context& context = context_of(shell);
  context.filtered.inverse_diagonal_blocks(context.inverse_blocks);
  *values = reinterpret_cast<const PetscScalar*>(context.inverse_blocks.data());
  PetscFunctionReturn(0);
}

/// What PCJACOBI asks a matrix for.
PetscErrorCode get_diagonal(Mat shell, Vec diagonal) {
  PetscFunctionBegin;
  Context& context = context_of(shell);
  std::vector<Mat3>& blocks = context.inverse_blocks;
  context.filtered.diagonal_blocks(blocks);
  PetscScalar* to = nullptr;
  PetscCall(VecGetArrayWrite(diagonal, &to));
  for (std::size_t i = 0; i < blocks.size(); ++i)
    for (int k = 0; k < 3; ++k) *to++ = blocks[i](k, k);
  PetscCall(VecRestoreArrayWrite(diagonal, &to));
  PetscFunctionReturn(0);
}

OwnedMat make_shell(const DistributedMesh& mesh, Context& context) {
  OwnedMat shell;
  const PetscInt rows = 3 * mesh.vertices.owned;
  check(MatCreateShell(mesh.comm, rows, rows, PETSC_DETERMINE, PETSC_DETERMINE, &context, shell.address()));
  check(MatSetBlockSize(shell, 3));
  check(MatSetOption(shell, MAT_SPD, PETSC_TRUE));
  check(MatShellSetOperation(shell, MATOP_MULT, reinterpret_cast<void (*)()>(multiply)));
  check(MatShellSetOperation(shell, MATOP_INVERT_BLOCK_DIAGONAL,
                             reinterpret_cast<void (*)()>(invert_diagonal_blocks)));
  check(MatShellSetOperation(shell, MATOP_GET_DIAGONAL, reinterpret_cast<void (*)()>(get_diagonal)));
  return shell;
}

bool works_unassembled(KSP ksp) {
  PC pc = nullptr;
  PetscBool does = PETSC_FALSE;
  check(KSPGetPC(ksp, &pc));
  check(
      PetscObjectTypeCompareAny(reinterpret_cast<PetscObject>(pc), &does, PCPBJACOBI, PCJACOBI, PCNONE, ""));
  return does;
}

std::span<Vec3> as_vectors(PetscScalar* values, Local count) {
  return {reinterpret_cast<Vec3*>(values), std::size_t(count)};
}

} // namespace

struct VelocitySystem::Petsc {
  Context context;
  OwnedMat shell;
  OwnedVec rhs, solution;
  LinearSolver solver;
  std::unique_ptr<AssembledMatrix> assembled; ///< only where the solver needs one
  std::vector<Vec3> product;                  ///< A v, over local vertices

  Petsc(const DistributedMesh& mesh, const SolverOptions& options)
      : context{FilteredOperator(mesh), {}}, solver(mesh.comm, "velocity", options, PCPBJACOBI) {}

  void start_residual(const VertexMatrix& matrix, std::span<const Vec3> b, std::span<const Vec3> v,
                      Local owned) {
    matrix.multiply(v, product);
    PetscScalar* values = nullptr;
    check(VecGetArrayWrite(rhs, &values));
    const auto residual = as_vectors(values, owned);
    for (Local i = 0; i < owned; ++i)
      residual[i] = context.filtered.prescribed(i) ? Vec3(Vec3::Zero()) : Vec3(b[i] - product[i]);
    check(VecRestoreArrayWrite(rhs, &values));
  }
};

VelocitySystem::VelocitySystem(const DistributedMesh& mesh, const Pattern& pattern,
                               const SolverOptions& options)
    : mesh_(mesh), petsc_(std::make_unique<Petsc>(mesh, options)) {
  Petsc& p = *petsc_;
  p.context.inverse_blocks.resize(mesh.vertices.owned);
  p.product.resize(mesh.vertices.size());
  p.shell = make_shell(mesh, p.context);
  check(MatCreateVecs(p.shell, p.solution.address(), p.rhs.address()));
  if (!works_unassembled(p.solver)) p.assembled = std::make_unique<AssembledMatrix>(mesh, pattern);
  const bool factorises = options.kind == SolverOptions::Kind::mumps;
  check(KSPSetOperators(p.solver, factorises ? Mat(*p.assembled) : Mat(p.shell),
                        p.assembled ? Mat(*p.assembled) : Mat(p.shell)));
}

VelocitySystem::~VelocitySystem() = default;

SolveReport VelocitySystem::solve(const VertexMatrix& matrix, std::span<const Vec3> rhs,
                                  std::span<const char> prescribed, double tolerance, std::vector<Vec3>& v) {
  Petsc& p = *petsc_;
  p.context.filtered.set(matrix, prescribed);
  if (p.assembled) p.assembled->assemble(p.context.filtered);
  mark_changed(p.shell);

  // The change of velocity is solved for, so that "relative" means relative to what the step changes.
  p.start_residual(matrix, rhs, v, mesh_.vertices.owned);
  const SolveReport report = p.solver.solve(p.rhs, p.solution, tolerance);
  PetscScalar* values = nullptr;
  check(VecGetArray(p.solution, &values));
  const auto change = as_vectors(values, mesh_.vertices.owned);
  for (Local i = 0; i < mesh_.vertices.owned; ++i) v[i] += change[i];
  check(VecRestoreArray(p.solution, &values));
  mesh_.vertex_halo.update(v);
  return report;
}

} // namespace taut
