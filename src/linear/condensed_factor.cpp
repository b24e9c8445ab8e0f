#include "src/linear/condensed_factor.hpp"

#include "partition/sort_unique.hpp"
#include "src/linear/krylov.hpp"
#include "src/linear/symmetric_matrix.hpp"

#include <algorithm>

namespace taut {

namespace {

/// J by owned rows.
class RowEntries {
public:
  RowEntries(std::span<const RowEdge> entries, std::size_t rows)
      : entries_(entries.begin(), entries.end()), first_(rows + 1) {
    std::stable_sort(entries_.begin(), entries_.end(),
                     [](const RowEdge& a, const RowEdge& b) { return a.row < b.row; });
    for (const RowEdge& e : entries_) ++first_[e.row + 1];
    for (std::size_t row = 0; row < rows; ++row) first_[row + 1] += first_[row];
  }

  std::size_t rows() const { return first_.size() - 1; }
  std::span<const RowEdge> of(std::size_t row) const {
    return std::span(entries_).subspan(first_[row], first_[row + 1] - first_[row]);
  }

private:
  std::vector<RowEdge> entries_;
  std::vector<std::size_t> first_;
};

} // namespace

/// A rank owns three rows of the matrix for each of its vertices.
struct CondensedFactor::Matrix {
  Matrix(const DistributedMesh& mesh, const Pattern& pattern, std::span<const RowEdge> entries,
         std::size_t rows);

  void fix_pattern();
  void fix_rows();
  void assemble(const FilteredOperator& stiffness, std::span<const Vec3> gradients,
                std::span<const double> compliance);
  void add(const FilteredOperator& stiffness);
  void add_row(std::span<const RowEdge> row, const Freedom& freedom, std::span<const Vec3> gradients,
               double stiffness);
  void add(const ContactCouplings& contacts, const Freedom& freedom);
  void note_vertices(std::span<const RowEdge> row);
  std::size_t place_in_row(Local vertex) const;

  const DistributedMesh& mesh;
  const Pattern& pattern;
  RowEntries rows;
  std::vector<Global> number;    ///< of local vertices in the order of the matrix's rows
  std::vector<Mat3> blocks;      ///< of H, in the pattern's order
  std::vector<Local> vertices;   ///< room, as the others: of a row
  std::vector<Vec3> gradient;    ///< at those, of the row of J
  std::vector<PetscInt> columns; ///< of blocks
  std::vector<PetscScalar> values;
  std::vector<double> yielding;         ///< a
  std::vector<PetscScalar> derivatives; ///< of rows by the vertices of each
  OwnedMat matrix, jacobian;
  OwnedVec rhs, solution, of_rows;
  LinearSolver solver;
};

CondensedFactor::Matrix::Matrix(const DistributedMesh& m, const Pattern& p, std::span<const RowEdge> e,
                                std::size_t n)
    : mesh(m), pattern(p), rows(e, n), number(m.vertices.size()), blocks(p.entries()),
      solver(m.comm, "kkt", {.kind = SolverOptions::Kind::mumps, .matrix = SolverOptions::Matrix::indefinite},
             PCNONE) {
  check_unknowns(mesh.comm, 3 * Global(mesh.vertices.owned));
  const Global first = exclusive_sum(mesh.comm, Global(mesh.vertices.owned));
  for (Local i = 0; i < mesh.vertices.owned; ++i) number[i] = first + i;
  mesh.vertex_halo.update(number);
  fix_pattern();
  fix_rows();
  check(MatCreateVecs(matrix, solution.address(), rhs.address()));
  check(MatCreateVecs(jacobian, nullptr, of_rows.address()));
  check(KSPSetOperators(solver, matrix, matrix));
  solver.leave_room_for_pivots();
}

/// That of H, and what rows couple beyond it.
void CondensedFactor::Matrix::fix_pattern() {
  std::vector<std::pair<Global, Global>> pairs;
  for (Local i = 0; i < mesh.vertices.owned; ++i)
    for (const Local j : pattern.columns(i)) pairs.emplace_back(number[i], number[j]);
  for (std::size_t row = 0; row < rows.rows(); ++row) {
    note_vertices(rows.of(row));
    for (const Local i : vertices)
      for (const Local j : vertices) pairs.emplace_back(number[i], number[j]);
  }
  sort_unique(pairs);
  EntryPlaces places;
  for (const auto& [i, j] : pairs)
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) places.add(PetscInt(3 * i + a), PetscInt(3 * j + b));
  matrix = make_symmetric_matrix(mesh.comm, "kkt_", PetscInt(3 * mesh.vertices.owned), std::move(places));
  values.assign(9 * pairs.size(), 0.0);
  // Until values were given, columns of other ranks are unknown to what is added later.
  check(MatSetValuesCOO(matrix, values.data(), INSERT_VALUES));
  check(MatSetBlockSize(matrix, 3));                                   // MUMPS orders blocks
  check(MatSetOption(matrix, MAT_NEW_NONZERO_LOCATIONS, PETSC_FALSE)); // leaves out what is far
}

void CondensedFactor::Matrix::fix_rows() {
  const auto n = PetscInt(rows.rows());
  const Global first = exclusive_sum(mesh.comm, Global(n));
  EntryPlaces places;
  for (std::size_t r = 0; r < rows.rows(); ++r) {
    note_vertices(rows.of(r));
    for (const Local v : vertices)
      for (int a = 0; a < 3; ++a) places.add(PetscInt(first + Global(r)), PetscInt(3 * number[v] + a));
  }
  check(MatCreate(mesh.comm, jacobian.address()));
  check(MatSetSizes(jacobian, n, 3 * mesh.vertices.owned, PETSC_DETERMINE, PETSC_DETERMINE));
  check(MatSetType(jacobian, MATAIJ));
  check(MatSetPreallocationCOO(jacobian, PetscCount(places.rows.size()), places.rows.data(),
                               places.columns.data()));
}

/// The vertices of a row of J.
void CondensedFactor::Matrix::note_vertices(std::span<const RowEdge> row) {
  vertices.clear();
  for (const RowEdge& e : row)
    for (const Local v : mesh.edge_vertices[e.edge])
      if (place_in_row(v) == vertices.size()) vertices.push_back(v);
}

std::size_t CondensedFactor::Matrix::place_in_row(Local vertex) const {
  return std::size_t(std::find(vertices.begin(), vertices.end(), vertex) - vertices.begin());
}

void CondensedFactor::Matrix::assemble(const FilteredOperator& stiffness, std::span<const Vec3> gradients,
                                       std::span<const double> compliance) {
  check(MatZeroEntries(matrix));
  add(stiffness);
  const Freedom& freedom = stiffness.freedom();
  yielding.assign(compliance.begin(), compliance.end());
  derivatives.clear();
  for (std::size_t r = 0; r < rows.rows(); ++r) add_row(rows.of(r), freedom, gradients, 1 / yielding[r]);
  check(MatSetValuesCOO(jacobian, derivatives.data(), INSERT_VALUES));
  if (const auto& contacts = stiffness.matrix().far()) add(*contacts, freedom);
  check(MatAssemblyBegin(matrix, MAT_FINAL_ASSEMBLY));
  check(MatAssemblyEnd(matrix, MAT_FINAL_ASSEMBLY));
}

void CondensedFactor::Matrix::add(const FilteredOperator& stiffness) {
  stiffness.blocks(blocks);
  for (Local i = 0; i < mesh.vertices.owned; ++i) {
    columns.clear();
    for (const Local j : pattern.columns(i)) columns.push_back(PetscInt(number[j]));
    const std::span<const Mat3> row(blocks.data() + pattern.offset(i), columns.size());
    values.clear();
    for (int a = 0; a < 3; ++a)
      for (const Mat3& block : row)
        for (int b = 0; b < 3; ++b) values.push_back(block(a, b));
    const auto at = PetscInt(number[i]);
    check(MatSetValuesBlocked(matrix, 1, &at, PetscInt(columns.size()), columns.data(), values.data(),
                              ADD_VALUES));
  }
}

void CondensedFactor::Matrix::add_row(std::span<const RowEdge> row, const Freedom& freedom,
                                      std::span<const Vec3> gradients, double stiffness) {
  note_vertices(row);
  gradient.assign(vertices.size(), Vec3::Zero());
  for (const RowEdge& e : row) {
    const auto& [i, j] = mesh.edge_vertices[e.edge];
    gradient[place_in_row(i)] -= e.factor * gradients[e.edge];
    gradient[place_in_row(j)] += e.factor * gradients[e.edge];
  }
  columns.clear();
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    gradient[k] = freedom.allowed(vertices[k], gradient[k]);
    columns.push_back(PetscInt(number[vertices[k]]));
    derivatives.insert(derivatives.end(), gradient[k].begin(), gradient[k].end());
  }
  values.clear();
  for (const Vec3& g : gradient)
    for (int a = 0; a < 3; ++a)
      for (const Vec3& h : gradient)
        for (int b = 0; b < 3; ++b) values.push_back(stiffness * g[a] * h[b]);
  const auto size = PetscInt(columns.size());
  check(MatSetValuesBlocked(matrix, size, columns.data(), size, columns.data(), values.data(), ADD_VALUES));
}

/// What of contacts lies between neighbours: on bodies, all.
void CondensedFactor::Matrix::add(const ContactCouplings& contacts, const Freedom& freedom) {
  std::vector<Mat3> projectors;
  for (Local i = 0; i < mesh.vertices.owned; ++i) projectors.push_back(freedom.projector(i));
  contacts.for_each(number, projectors, [&](std::span<const ContactCouplings::Part> parts) {
    for (const auto& [row, g] : parts)
      for (const auto& [column, h] : parts) {
        const Mat3 transposed = h * g.transpose(); // of the block, which PETSc reads by rows
        const auto r = PetscInt(row), c = PetscInt(column);
        check(MatSetValuesBlocked(matrix, 1, &r, 1, &c, transposed.data(), ADD_VALUES));
      }
  });
}

CondensedFactor::CondensedFactor(const DistributedMesh& mesh, const Pattern& pattern,
                                 std::span<const RowEdge> entries, std::size_t rows)
    : matrix_(std::make_unique<Matrix>(mesh, pattern, entries, rows)) {}

CondensedFactor::~CondensedFactor() = default;

void CondensedFactor::factor(const FilteredOperator& stiffness, std::span<const Vec3> gradients,
                             std::span<const double> compliance) {
  matrix_->assemble(stiffness, gradients, compliance);
}

SolveReport CondensedFactor::solve(std::span<const double> rhs, std::span<double> solution) {
  constexpr double tolerance = 1e-6; // of which a direct solver knows nothing
  Matrix& system = *matrix_;
  const std::size_t n = 3 * std::size_t(system.mesh.vertices.owned);
  const auto c = rhs.subspan(n);
  const auto m = solution.subspan(n);
  for (std::size_t r = 0; r < c.size(); ++r) m[r] = -c[r] / system.yielding[r];
  put(rhs.first(n), system.rhs);
  put(m, system.of_rows);
  check(MatMultTransposeAdd(system.jacobian, system.of_rows, system.rhs, system.rhs));
  const SolveReport report = system.solver.solve(system.rhs, system.solution, tolerance);
  take(system.solution, solution.first(n));
  check(MatMult(system.jacobian, system.solution, system.of_rows));
  take(system.of_rows, m);
  for (std::size_t r = 0; r < c.size(); ++r) m[r] = -(c[r] + m[r]) / system.yielding[r];
  return report;
}

} // namespace taut
