#include "src/linear/velocity_system.hpp"

#include "src/linear/assembled.hpp"
#include "src/linear/krylov.hpp"
#include "src/linear/modified_cg.hpp"
#include "src/linear/unassembled.hpp"

#include <algorithm>

namespace taut {

namespace {

bool works_unassembled(KSP ksp) {
  PC pc = nullptr;
  PetscBool does = PETSC_FALSE;
  check(KSPGetPC(ksp, &pc));
  check(PetscObjectTypeCompareAny(reinterpret_cast<PetscObject>(pc), &does, "axis", "grids", PCPBJACOBI,
                                  PCJACOBI, PCNONE, ""));
  return does;
}

const char* name_of(SolverOptions::Preconditioner preconditioner) {
  return preconditioner == SolverOptions::Preconditioner::grids ? "grids" : "axis";
}

} // namespace

struct VelocitySystem::Petsc {
  UnassembledMatrix unassembled;
  OwnedVec rhs, solution;
  LinearSolver solver;
  std::unique_ptr<AssembledMatrix> assembled; ///< only where the solver needs one

  Petsc(const DistributedMesh& mesh, const Pattern& pattern, const SolverOptions& options, const char* name)
      : unassembled(mesh, pattern), solver(mesh.comm, name, options, name_of(options.preconditioner)) {
    check(MatCreateVecs(unassembled, solution.address(), rhs.address()));
    if (!works_unassembled(solver)) assembled = std::make_unique<AssembledMatrix>(mesh, pattern);
    const bool factorises = options.kind == SolverOptions::Kind::mumps;
    check(KSPSetOperators(solver, factorises ? Mat(*assembled) : Mat(unassembled),
                          assembled ? Mat(*assembled) : Mat(unassembled)));
  }

  void start_residual(std::span<const Vec3> b, const Freedom& freedom, std::span<const Vec3> v) {
    const auto product = unassembled.filtered().unfiltered_product(v);
    double* values = nullptr;
    check(VecGetArrayWrite(rhs, &values));
    for (Local i = 0; i < unassembled.filtered().matrix().pattern().rows(); ++i)
      Eigen::Map<Vec3>(values + 3 * i) = freedom.allowed(i, b[i] - product[i]);
    check(VecRestoreArrayWrite(rhs, &values));
  }

  /// Preconditioners mix directions, so what is denied is only nearly zero in the solution.
  void add_solution(const Freedom& freedom, std::span<Vec3> v) const {
    const double* values = nullptr;
    check(VecGetArrayRead(solution, &values));
    for (std::size_t i = 0; i < v.size(); ++i)
      v[i] += freedom.allowed(Local(i), Eigen::Map<const Vec3>(values + 3 * i));
    check(VecRestoreArrayRead(solution, &values));
  }
};

VelocitySystem::VelocitySystem(const DistributedMesh& mesh, const Pattern& pattern,
                               const SolverOptions& options, const char* name)
    : mesh_(mesh), options_(options), petsc_(std::make_unique<Petsc>(mesh, pattern, options, name)) {}

VelocitySystem::~VelocitySystem() = default;

SolveReport VelocitySystem::solve(const VertexMatrix& matrix, std::span<const Vec3> rhs,
                                  const Freedom& freedom, double tolerance, std::vector<Vec3>& v) {
  if (options_.constraints == SolverOptions::Constraints::filtered)
    return modified_cg(mesh_, matrix, rhs, freedom, tolerance, options_.max_iterations, v);
  Petsc& p = *petsc_;
  p.unassembled.set(matrix, freedom);
  if (p.assembled) p.assembled->assemble(p.unassembled.filtered());

  // The change of velocity is solved for, so that "relative" means relative to what the step changes.
  p.start_residual(rhs, freedom, v);
  const SolveReport report = p.solver.solve(p.rhs, p.solution, tolerance);
  p.add_solution(freedom, std::span(v).first(mesh_.vertices.owned));
  mesh_.vertex_halo.update(v);
  return report;
}

} // namespace taut
