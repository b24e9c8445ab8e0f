#include "src/linear/saddle_point_factor.hpp"

#include "src/linear/krylov.hpp"
#include "src/linear/symmetric_matrix.hpp"

namespace taut {

/// A rank owns three rows of the matrix for each of its vertices, then those of J.
struct SaddlePointFactor::Matrix {
  Matrix(const DistributedMesh& mesh, const Pattern& pattern, std::span<const RowEdge> entries,
         std::size_t rows);

  void number();
  void fix_pattern();
  void assemble(const FilteredOperator& stiffness, std::span<const Vec3> gradients,
                std::span<const double> compliance);
  void add(const ContactCouplings& contacts, const Freedom& freedom);
  PetscInt size() const { return PetscInt(3 * mesh.vertices.owned + rows); }
  PetscInt place_of(std::size_t row) const { return first + PetscInt(3 * mesh.vertices.owned + row); }

  const DistributedMesh& mesh;
  const Pattern& pattern;
  std::span<const RowEdge> entries;
  std::size_t rows;
  PetscInt first = 0;               ///< of the rows of this rank
  std::vector<Global> vertex_place; ///< first row of local vertices
  std::vector<Mat3> blocks;         ///< of H, in the pattern's order
  std::vector<PetscScalar> values;  ///< in the order of `fix_pattern`
  OwnedMat matrix;
  OwnedVec rhs, solution;
  LinearSolver solver;
};

SaddlePointFactor::Matrix::Matrix(const DistributedMesh& m, const Pattern& p, std::span<const RowEdge> e,
                                  std::size_t n)
    : mesh(m), pattern(p), entries(e), rows(n), vertex_place(m.vertices.size()), blocks(p.entries()),
      solver(m.comm, "kkt", {.kind = SolverOptions::Kind::mumps, .matrix = SolverOptions::Matrix::indefinite},
             PCNONE) {
  number();
  fix_pattern();
  check(MatCreateVecs(matrix, solution.address(), rhs.address()));
  check(KSPSetOperators(solver, matrix, matrix));
  solver.leave_room_for_pivots();
}

void SaddlePointFactor::Matrix::number() {
  check_unknowns(mesh.comm, 3 * Global(mesh.vertices.owned) + Global(rows));
  first = PetscInt(exclusive_sum(mesh.comm, size()));
  for (Local i = 0; i < mesh.vertices.owned; ++i) vertex_place[i] = first + 3 * i;
  mesh.vertex_halo.update(vertex_place);
}

/// H by rows of vertices; J and J^T together, by the owner of J's row; then the diagonal of a.
void SaddlePointFactor::Matrix::fix_pattern() {
  EntryPlaces places;
  for (Local i = 0; i < mesh.vertices.owned; ++i)
    for (const Local j : pattern.columns(i))
      for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b) places.add(PetscInt(vertex_place[i]) + a, PetscInt(vertex_place[j]) + b);
  for (const RowEdge& e : entries)
    for (const Local v : mesh.edge_vertices[e.edge])
      for (int a = 0; a < 3; ++a) {
        places.add(place_of(e.row), PetscInt(vertex_place[v]) + a);
        places.add(PetscInt(vertex_place[v]) + a, place_of(e.row));
      }
  for (std::size_t r = 0; r < rows; ++r) places.add(place_of(r), place_of(r));
  values.reserve(places.rows.size());
  matrix = make_symmetric_matrix(mesh.comm, "kkt_", size(), std::move(places));
  check(MatSetOption(matrix, MAT_NEW_NONZERO_LOCATIONS, PETSC_FALSE)); // leaves out what is far
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
      const double factor = end == 0 ? e.factor : -e.factor; // of -J
      const Vec3 g = factor * freedom.allowed(mesh.edge_vertices[e.edge][end], gradients[e.edge]);
      for (int a = 0; a < 3; ++a) values.insert(values.end(), 2, g[a]);
    }
  for (const double a : compliance) values.push_back(-a);
  check(MatSetValuesCOO(matrix, values.data(), INSERT_VALUES));
  if (const auto& contacts = stiffness.matrix().far()) add(*contacts, freedom);
}

/// What of contacts lies between neighbours: on bodies, all.
void SaddlePointFactor::Matrix::add(const ContactCouplings& contacts, const Freedom& freedom) {
  std::vector<Mat3> projectors;
  for (Local i = 0; i < mesh.vertices.owned; ++i) projectors.push_back(freedom.projector(i));
  contacts.for_each(vertex_place, projectors, [&](std::span<const ContactCouplings::Part> parts) {
    for (const auto& [row, g] : parts)
      for (const auto& [column, h] : parts) {
        const Mat3 transposed = h * g.transpose(); // of the block, which PETSc reads by rows
        const PetscInt r = PetscInt(row), c = PetscInt(column);
        const std::array<PetscInt, 3> rows_of{r, r + 1, r + 2}, columns_of{c, c + 1, c + 2};
        check(MatSetValues(matrix, 3, rows_of.data(), 3, columns_of.data(), transposed.data(), ADD_VALUES));
      }
  });
  check(MatAssemblyBegin(matrix, MAT_FINAL_ASSEMBLY));
  check(MatAssemblyEnd(matrix, MAT_FINAL_ASSEMBLY));
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
