#include "src/linear/saddle_point_factor.hpp"

#include "src/linear/krylov.hpp"

#include <limits>

namespace taut {

namespace {

/// Of what a row yields in the metric of the diagonal of H: far above rounding, far below what the step asks
/// for.
constexpr double little = 1e-8;

} // namespace

/// A rank owns three rows of the matrix for each of its vertices, then those of J.
struct SaddlePointFactor::Matrix {
  Matrix(const DistributedMesh& mesh, const Pattern& pattern, std::span<const RowEdge> entries,
         std::size_t rows);

  void number();
  void fix_pattern();
  void assemble(const FilteredOperator& stiffness, std::span<const Vec3> gradients,
                std::span<const double> compliance);
  std::vector<double> yields(std::span<const Vec3> gradients, const Freedom& freedom) const;
  PetscInt size() const { return PetscInt(3 * mesh.vertices.owned + rows); }
  PetscInt place_of(std::size_t row) const { return first + PetscInt(3 * mesh.vertices.owned + row); }

  const DistributedMesh& mesh;
  const Pattern& pattern;
  std::vector<RowEdge> entries;
  std::size_t rows;
  PetscInt first = 0;                 ///< of the rows of this rank
  std::vector<PetscInt> vertex_place; ///< first row of local vertices
  std::vector<Mat3> blocks;           ///< of H, in the pattern's order
  std::vector<PetscScalar> values;    ///< in the order of `fix_pattern`
  OwnedMat matrix;
  OwnedVec rhs, solution;
  LinearSolver solver;
};

SaddlePointFactor::Matrix::Matrix(const DistributedMesh& m, const Pattern& p, std::span<const RowEdge> e,
                                  std::size_t n)
    : mesh(m), pattern(p), entries(e.begin(), e.end()), rows(n), vertex_place(m.vertices.size()),
      blocks(p.entries()),
      solver(m.comm, "kkt", {.kind = SolverOptions::Kind::mumps, .matrix = SolverOptions::Matrix::indefinite},
             PCNONE) {
  number();
  check(MatCreate(mesh.comm, matrix.address()));
  check(MatSetOptionsPrefix(matrix, "kkt_"));
  check(MatSetSizes(matrix, size(), size(), PETSC_DETERMINE, PETSC_DETERMINE));
  check(MatSetType(matrix, MATAIJ));
  fix_pattern();
  check(MatSetOption(matrix, MAT_SYMMETRIC, PETSC_TRUE));
  check(MatSetOption(matrix, MAT_SYMMETRY_ETERNAL, PETSC_TRUE));
  check(MatCreateVecs(matrix, solution.address(), rhs.address()));
  check(KSPSetOperators(solver, matrix, matrix));
  solver.leave_room_for_pivots();
}

void SaddlePointFactor::Matrix::number() {
  if (sum_over(mesh.comm, Global(size())) > std::numeric_limits<PetscInt>::max())
    throw std::runtime_error(
        "the mesh has more unknowns than this PETSc can number: use one with 64-bit indices");
  first = PetscInt(exclusive_sum(mesh.comm, size()));
  for (Local i = 0; i < mesh.vertices.owned; ++i) vertex_place[i] = first + 3 * i;
  mesh.vertex_halo.update(vertex_place);
}

/// H by rows of vertices; J and J^T together, by the owner of J's row; then the diagonal of a.
void SaddlePointFactor::Matrix::fix_pattern() {
  std::vector<PetscInt> row, column;
  const auto add = [&](PetscInt r, PetscInt c) {
    row.push_back(r);
    column.push_back(c);
  };
  for (Local i = 0; i < mesh.vertices.owned; ++i)
    for (const Local j : pattern.columns(i))
      for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b) add(vertex_place[i] + a, vertex_place[j] + b);
  for (const RowEdge& e : entries)
    for (const Local v : mesh.edge_vertices[e.edge])
      for (int a = 0; a < 3; ++a) {
        add(place_of(e.row), vertex_place[v] + a);
        add(vertex_place[v] + a, place_of(e.row));
      }
  for (std::size_t r = 0; r < rows; ++r) add(place_of(r), place_of(r));
  values.reserve(row.size());
  check(MatSetPreallocationCOO(matrix, PetscCount(row.size()), row.data(), column.data()));
}

/// About the diagonal of J W J^T for W = 3 / trace H_ii.
std::vector<double> SaddlePointFactor::Matrix::yields(std::span<const Vec3> gradients,
                                                      const Freedom& freedom) const {
  std::vector<double> metric(mesh.vertices.size()), result(rows, 0.0);
  for (Local i = 0; i < mesh.vertices.owned; ++i)
    metric[i] = freedom.is_held(i) ? 0.0 : 3.0 / blocks[pattern.diagonal(i)].trace();
  mesh.vertex_halo.update(metric);
  for (const RowEdge& e : entries) {
    const auto& [a, b] = mesh.edge_vertices[e.edge];
    result[e.row] += e.factor * e.factor * gradients[e.edge].squaredNorm() * (metric[a] + metric[b]);
  }
  return result;
}

void SaddlePointFactor::Matrix::assemble(const FilteredOperator& stiffness, std::span<const Vec3> gradients,
                                         std::span<const double> compliance) {
  stiffness.blocks(blocks);
  values.clear();
  for (const Mat3& block : blocks)
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) values.push_back(block(a, b));
  const Freedom& freedom = stiffness.freedom();
  for (const RowEdge& e : entries)
    for (int end = 0; end < 2; ++end) {
      const double factor = end == 1 ? e.factor : -e.factor;
      const Vec3 g = factor * freedom.allowed(mesh.edge_vertices[e.edge][end], gradients[e.edge]);
      for (int a = 0; a < 3; ++a) values.insert(values.end(), 2, g[a]);
    }
  const std::vector<double> yield = yields(gradients, freedom);
  for (std::size_t r = 0; r < rows; ++r) values.push_back(-compliance[r] - little * yield[r]);
  check(MatSetValuesCOO(matrix, values.data(), INSERT_VALUES));
}

SaddlePointFactor::SaddlePointFactor(const DistributedMesh& mesh, const Pattern& pattern,
                                     std::span<const RowEdge> entries, std::size_t rows)
    : matrix_(std::make_unique<Matrix>(mesh, pattern, entries, rows)) {}

SaddlePointFactor::~SaddlePointFactor() = default;

void SaddlePointFactor::factor(const FilteredOperator& stiffness, std::span<const Vec3> gradients,
                               std::span<const double> compliance) {
  matrix_->assemble(stiffness, gradients, compliance);
}

SolveReport SaddlePointFactor::solve(std::span<const double> rhs, std::span<double> solution) {
  constexpr double tolerance = 1e-6; // of which a direct solver knows nothing
  put(rhs, matrix_->rhs);
  const SolveReport report = matrix_->solver.solve(matrix_->rhs, matrix_->solution, tolerance);
  take(matrix_->solution, solution);
  return report;
}

} // namespace taut
