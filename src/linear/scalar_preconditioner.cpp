#include "src/linear/scalar_preconditioner.hpp"

namespace taut {

ScalarPreconditioner::ScalarPreconditioner(const DistributedMesh& mesh, const Pattern& pattern)
    : mesh_(mesh), pattern_(pattern), values_(pattern.entries()), held_(mesh.vertices.size()),
      fine_(pattern.sparse_rows()) {}

void ScalarPreconditioner::factor(const VertexMatrix& matrix, const Freedom& freedom) {
  collect(matrix);
  leave_out(freedom);
  uses_grids_ = needs_grids();
  fine_.factor(pattern_.sparse_rows(), values_);
  if (!uses_grids_) return;
  if (grids_.empty()) make_grids();
  SparseRows rows = pattern_.sparse_rows();
  std::span<const double> values = values_;
  std::span<const char> held = held_;
  for (const auto& level : grids_) {
    level->grid.start(held);
    level->grid.add(rows, values);
    level->grid.finish();
    rows = level->grid.rows();
    values = level->grid.values();
    held = {};
    level->factor.factor(rows, values);
  }
}

/// Whether the diagonal outweighs inertia, which is what sums of rows are, so much that a solve with grids
/// takes no longer than without. Factors within ranks know nothing of what couples these, so on several that
/// is so earlier.
bool ScalarPreconditioner::needs_grids() const {
  const double much = size_of(mesh_.comm) == 1 ? 150 : 50;
  std::array<double, 2> sums{0, 0}; // of the diagonal, of all entries
  auto value = values_.begin();
  for (Local row = 0; row < pattern_.rows(); ++row) {
    if (!held_[row]) sums[0] += values_[pattern_.diagonal(row)];
    for (const Local column : pattern_.columns(row)) {
      if (!held_[row] && !held_[column]) sums[1] += *value;
      ++value;
    }
  }
  sum_in_place(mesh_.comm, sums);
  return sums[0] > much * sums[1];
}

void ScalarPreconditioner::make_grids() {
  constexpr double ratio = 4;        // of the spacings of two grids
  constexpr Global few_points = 500; // need no grid of their own
  double spacing = mean_edge(mesh_);
  SparseRows rows = pattern_.sparse_rows();
  std::span<const Vec3> points = mesh_.rest_positions;
  for (Global total = mesh_.vertices.total; total > few_points; total = grids_.back()->grid.total()) {
    spacing *= ratio;
    SplineGrid<2, double> grid(mesh_.comm, rows, points, spacing);
    if (2 * grid.total() > total) return;
    IncompleteCholesky factor(grid.rows());
    const std::vector<Vec3> field(grid.points().size());
    grids_.push_back(std::make_unique<Coarse>(Coarse{std::move(grid), std::move(factor), field, field}));
    rows = grids_.back()->grid.rows();
    points = grids_.back()->grid.points();
  }
}

void ScalarPreconditioner::collect(const VertexMatrix& matrix) {
  std::copy(matrix.values().begin(), matrix.values().end(), values_.begin());
  matrix.for_each_rank_one([&](const auto& r) {
    for (std::size_t a = 0; a < r.vertices.size(); ++a) {
      const Local row = r.vertices[a];
      if (row >= pattern_.rows()) continue;
      for (std::size_t b = 0; b < r.vertices.size(); ++b)
        values_[pattern_.slot(row, r.vertices[b])] += r.gradient[a].dot(r.gradient[b]) / 3.0;
    }
  });
  if (!matrix.far()) return;
  for (Local row = 0; row < pattern_.rows(); ++row)
    values_[pattern_.diagonal(row)] += matrix.far()->diagonal_blocks()[row].trace() / 3.0;
}

void ScalarPreconditioner::leave_out(const Freedom& freedom) {
  for (std::size_t i = 0; i < held_.size(); ++i) held_[i] = freedom.is_held(Local(i));
  auto value = values_.begin();
  for (Local row = 0; row < pattern_.rows(); ++row)
    for (const Local column : pattern_.columns(row)) {
      if (held_[row] || held_[column]) *value = row == column ? 1.0 : 0.0;
      ++value;
    }
}

void ScalarPreconditioner::solve(std::span<const Vec3> b, std::span<Vec3> x) const {
  fine_.solve(b, x);
  if (uses_grids_) add_correction(0, b, x);
}

/// Of the grids from `level` on.
void ScalarPreconditioner::add_correction(std::size_t level, std::span<const Vec3> b,
                                          std::span<Vec3> x) const {
  if (level == grids_.size()) return;
  const Coarse& coarse = *grids_[level];
  coarse.grid.gather(b, coarse.b);
  coarse.factor.solve(coarse.b, coarse.x);
  add_correction(level + 1, coarse.b, coarse.x);
  coarse.grid.add_spread(coarse.x, x);
}

} // namespace taut
