#include "src/linear/metric_system.hpp"

#include "src/linear/krylov.hpp"

namespace taut {

namespace {

/// What `name` is to be unless the user says otherwise.
void set_default(const char* name, const char* value) {
  PetscBool given = PETSC_FALSE;
  check(PetscOptionsHasName(nullptr, nullptr, name, &given));
  if (!given) check(PetscOptionsSetValue(nullptr, name, value));
}

/// Algebraic multigrid by smoothed aggregation: smoothed by Chebyshev's polynomials of symmetric
/// Gauss-Seidel, and the aggregates, which depend little on the state, made once. On a draped 121 x 121 mesh
/// 16 iterations of CG, where polynomials of the diagonal took 51, incomplete Cholesky 158, and diagonal
/// blocks 182.
void set_up_multigrid(KSP solver) {
  PC pc = nullptr;
  PetscBool chosen = PETSC_FALSE;
  check(KSPGetPC(solver, &pc));
  check(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(pc), PCGAMG, &chosen));
  if (!chosen) return; // MUMPS, or the user's choice
  check(PCGAMGSetReuseInterpolation(pc, PETSC_TRUE));
  set_default("-projection_mg_levels_pc_type", "sor");
}

} // namespace

struct MetricSystem::Petsc {
  OwnedMat matrix;
  OwnedVec rhs, solution;
  LinearSolver solver;

  Petsc(MPI_Comm comm, const SolverOptions& options, Preconditioner preconditioner)
      : solver(comm, "projection", options, preconditioner == Preconditioner::sweep ? PCSOR : PCGAMG) {
    set_up_multigrid(solver);
  }
};

MetricSystem::MetricSystem(const DistributedMesh& mesh, std::span<const std::size_t> begin,
                           std::span<const Local> rows, const SolverOptions& options,
                           Preconditioner preconditioner)
    : mesh_(mesh), begin_(begin.begin(), begin.end()),
      petsc_(std::make_unique<Petsc>(mesh.comm, options, preconditioner)) {
  std::vector<PetscInt> i, j;
  const auto add = [&](Local row, int k, Local column, int l) {
    i.push_back(PetscInt(2 * mesh.vertices.global(row) + k));
    j.push_back(PetscInt(2 * mesh.vertices.global(column) + l));
  };
  for (std::size_t p = 0; p + 1 < begin_.size(); ++p)
    for (std::size_t r = begin_[p]; r < begin_[p + 1]; ++r)
      for (std::size_t c = begin_[p]; c < begin_[p + 1]; ++c)
        for (int k = 0; k < 4; ++k) add(rows[r], k / 2, rows[c], k % 2);
  for (Local v = 0; v < mesh.vertices.owned; ++v)
    for (int k = 0; k < 2; ++k) add(v, k, v, k);
  values_.resize(i.size());
  Petsc& p = *petsc_;
  const PetscInt owned = 2 * mesh.vertices.owned;
  check(MatCreate(mesh.comm, p.matrix.address()));
  check(MatSetSizes(p.matrix, owned, owned, PETSC_DETERMINE, PETSC_DETERMINE));
  check(MatSetType(p.matrix, MATAIJ));
  check(MatSetBlockSize(p.matrix, 2));
  check(MatSetPreallocationCOO(p.matrix, PetscCount(i.size()), i.data(), j.data()));
  check(MatSetOption(p.matrix, MAT_SPD, PETSC_TRUE));
  check(MatCreateVecs(p.matrix, p.solution.address(), p.rhs.address()));
}

MetricSystem::~MetricSystem() = default;

void MetricSystem::assemble(std::span<const std::array<Vec3, 2>> columns,
                            std::span<const double> inverse_mass, const Freedom& freedom,
                            std::span<const Vec2> scaled_compliance) {
  auto value = values_.begin();
  for (std::size_t p = 0; p + 1 < begin_.size(); ++p)
    for (std::size_t r = begin_[p]; r < begin_[p + 1]; ++r) {
      const Vec3 warp = inverse_mass[p] * freedom.allowed(Local(p), columns[r][0]),
                 weft = inverse_mass[p] * freedom.allowed(Local(p), columns[r][1]);
      for (std::size_t c = begin_[p]; c < begin_[p + 1]; ++c)
        for (int k = 0; k < 4; ++k) *value++ = (k / 2 == 0 ? warp : weft).dot(columns[c][k % 2]);
    }
  for (const Vec2& a : scaled_compliance)
    for (const double s : a) *value++ = s;
  check(MatSetValuesCOO(petsc_->matrix, values_.data(), INSERT_VALUES));
}

SolveReport MetricSystem::solve(std::span<const Vec2> rhs, double tolerance, std::vector<Vec2>& mu) {
  Petsc& p = *petsc_;
  check(KSPSetOperators(p.solver, p.matrix, p.matrix));
  const auto size = std::size_t(2 * mesh_.vertices.owned);
  put({reinterpret_cast<const double*>(rhs.data()), size}, p.rhs);
  const SolveReport report = p.solver.solve(p.rhs, p.solution, tolerance);
  take(p.solution, {reinterpret_cast<double*>(mu.data()), size});
  mesh_.vertex_halo.update(mu);
  return report;
}

void MetricSystem::precondition(std::span<const double> r, std::span<double> s) const {
  Petsc& p = *petsc_;
  PC pc = nullptr;
  check(KSPSetOperators(p.solver, p.matrix, p.matrix));
  check(KSPGetPC(p.solver, &pc));
  put(r, p.rhs);
  check(PCApply(pc, p.rhs, p.solution));
  take(p.solution, s);
}

void MetricSystem::multiply(std::span<const double> mu, std::span<double> product) const {
  put(mu, petsc_->solution);
  check(MatMult(petsc_->matrix, petsc_->solution, petsc_->rhs));
  take(petsc_->rhs, product);
}

} // namespace taut
