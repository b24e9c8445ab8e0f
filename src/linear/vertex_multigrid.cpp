#include "src/linear/vertex_multigrid.hpp"

#include <Eigen/LU>

#include <numeric>

namespace taut {

namespace {

constexpr double ratio = 3; // of the spacings of two grids
constexpr Global few_nodes = 50;
constexpr int vertex_steps = 2, grid_steps = 1; // that smooth

/// Of the k-th step of Chebyshev's polynomials of the fourth kind, for eigenvalues of D^-1 A from 0 to 1.
double momentum(int k) { return (2.0 * k - 3) / (2 * k + 1); }
double weight(int k) { return (8.0 * k - 4) / (2 * k + 1); }

/// D^-1; where D has no entries, 0. What is too small to be more than round-off belongs to directions that
/// nothing depends on.
Mat3 smoother_of(const Mat3& d) {
  constexpr double round_off = 1e-12;
  const double size = d.trace();
  return size > 0 ? Mat3((d + round_off * size * Mat3::Identity()).inverse()) : Mat3(Mat3::Zero());
}

} // namespace

VertexMultigrid::VertexMultigrid(const DistributedMesh& mesh, const Pattern& pattern)
    : mesh_(mesh), pattern_(pattern), smoother_(mesh.vertices.owned), step_(mesh.vertices.owned),
      product_(mesh.vertices.owned) {
  double spacing = ratio * mean_edge(mesh);
  SparseRows rows = pattern.sparse_rows();
  std::span<const Vec3> points = mesh.rest_positions;
  do {
    SplineGrid<1, Mat3> next(mesh.comm, rows, points, spacing);
    const std::vector<Mat3> smoother(next.nodes().owned);
    const std::vector<Vec3> field(next.nodes().size()), owned(next.nodes().owned);
    levels_.push_back(std::make_unique<Level>(Level{std::move(next), smoother, field, field, owned}));
    spacing *= ratio;
    rows = levels_.back()->grid.rows();
    points = levels_.back()->grid.points();
  } while (levels_.back()->grid.total() > few_nodes);
  coarsest_values_.resize(3 * std::size_t(levels_.back()->grid.total()));
}

void VertexMultigrid::set(const FilteredOperator& matrix) {
  matrix_ = &matrix;
  make_matrices();
  make_vertex_smoother();
  for (std::size_t k = 0; k + 1 < levels_.size(); ++k) make_smoother(*levels_[k]);
  factor_coarsest();
}

void VertexMultigrid::make_matrices() {
  const VertexMatrix& fine = matrix_->matrix();
  SplineGrid<1, Mat3>& first = levels_[0]->grid;
  first.start(matrix_->freedom());
  first.add(pattern_.sparse_rows(), fine.values());
  fine.for_each_rank_one([&](const auto& r) { first.add_rank_one(r.vertices, r.gradient); });
  if (fine.far()) {
    std::vector<std::int64_t> offsets(std::size_t(mesh_.vertices.owned) + 1);
    std::iota(offsets.begin(), offsets.end(), 0);
    std::vector<Local> columns(mesh_.vertices.owned);
    std::iota(columns.begin(), columns.end(), 0);
    first.add({offsets, columns}, fine.far()->diagonal_blocks());
  }
  first.finish();
  for (std::size_t k = 1; k < levels_.size(); ++k) {
    const SplineGrid<1, Mat3>& finer = levels_[k - 1]->grid;
    levels_[k]->grid.start();
    levels_[k]->grid.add(finer.rows(), finer.values());
    levels_[k]->grid.finish();
  }
}

/// D is what is known to be no less than A: of a matrix of numbers the sums of its rows' absolute values, and
/// of g g^T, over several vertices, as many times each block as makes up for those beside it:
/// (sum |g_j| s_j)^2 <= (sum |g_j|) sum |g_j| s_j^2. Neither depends on the partition.
void VertexMultigrid::make_vertex_smoother() {
  const VertexMatrix& fine = matrix_->matrix();
  const Freedom& freedom = matrix_->freedom();
  auto value = fine.values().begin();
  for (Local row = 0; row < pattern_.rows(); ++row) {
    double sum = 0;
    for (const Local column : pattern_.columns(row)) {
      if (!freedom.is_held(column)) sum += std::abs(*value);
      ++value;
    }
    smoother_[row] = sum * Mat3::Identity();
  }
  fine.for_each_rank_one([&](const auto& r) {
    std::array<double, std::tuple_size_v<std::decay_t<decltype(r.vertices)>>> size;
    double sum = 0;
    for (std::size_t a = 0; a < size.size(); ++a) {
      size[a] = freedom.is_held(r.vertices[a]) ? 0.0 : r.gradient[a].norm();
      sum += size[a];
    }
    for (std::size_t a = 0; a < size.size(); ++a)
      if (size[a] > 0 && r.vertices[a] < pattern_.rows())
        smoother_[r.vertices[a]] += sum / size[a] * r.gradient[a] * r.gradient[a].transpose();
  });
  if (fine.far()) {
    constexpr double vertices = 4; // of a term, at most
    for (Local i = 0; i < pattern_.rows(); ++i) smoother_[i] += vertices * fine.far()->diagonal_blocks()[i];
  }
  for (Local i = 0; i < pattern_.rows(); ++i) {
    Mat3 d = smoother_[i];
    if (!freedom.is_free(i)) d = matrix_->filtered(i, i, d);
    smoother_[i] = smoother_of(d);
  }
}

/// D as above, of 3 x 3 blocks: 2 x^T M y <= sum_ab |m_ab| (x_a^2 + y_b^2).
void VertexMultigrid::make_smoother(Level& level) {
  const SparseRows rows = level.grid.rows();
  auto block = level.grid.values().begin();
  for (Local row = 0; row < rows.size(); ++row) {
    Mat3 d = Mat3::Zero();
    for (const Local column : rows.columns(row)) {
      if (column == row)
        d += *block;
      else
        d.diagonal() += block->cwiseAbs().rowwise().sum();
      ++block;
    }
    level.smoother[row] = smoother_of(d);
  }
}

/// Nodes and directions that nothing depends on have zeros: the shift makes something of these, and as b is 0
/// there, so is the solution. It is small beside each row, as that of a node is small that little depends on.
void VertexMultigrid::factor_coarsest() {
  const SplineGrid<1, Mat3>& grid = levels_.back()->grid;
  const Eigen::Index size = 3 * grid.total();
  Eigen::MatrixXd whole = Eigen::MatrixXd::Zero(size, size);
  auto block = grid.values().begin();
  for (Local row = 0; row < grid.rows().size(); ++row)
    for (const Local column : grid.rows().columns(row))
      whole.block<3, 3>(3 * grid.nodes().global(row), 3 * grid.nodes().global(column)) = *block++;
  sum_in_place(mesh_.comm, {whole.data(), std::size_t(whole.size())});
  const Eigen::ArrayXd diagonal = whole.diagonal();
  const Eigen::ArrayXd scale = (diagonal > 0).select(diagonal, 1.0);
  for (double shift = 1e-12;; shift *= 100) {
    whole.diagonal().array() += shift * scale;
    coarsest_.compute(whole);
    if (coarsest_.info() == Eigen::Success) return;
  }
}

void VertexMultigrid::solve(std::span<const Vec3> b, std::span<Vec3> x) const {
  restrict_all(levels_.size(), b);
  solve_coarsest();
  rise_from(levels_.size() - 1, b, x);
}

void VertexMultigrid::solve(std::span<const Vec3> b, std::size_t k, std::span<const Vec3> start,
                            std::span<Vec3> x) const {
  restrict_all(k, b);
  std::copy_n(start.begin(), levels_[k]->grid.nodes().owned, levels_[k]->x.begin());
  rise_from(k, b, x);
}

void VertexMultigrid::restrict_to(std::size_t k, std::span<const Vec3> b, std::vector<Vec3>& coarse) const {
  restrict_all(k + 1, b);
  const auto& restricted = levels_[k]->b;
  coarse.assign(restricted.begin(), restricted.begin() + levels_[k]->grid.nodes().owned);
}

/// Onto the first so many grids.
void VertexMultigrid::restrict_all(std::size_t grids, std::span<const Vec3> b) const {
  for (std::size_t k = 0; k < grids; ++k)
    levels_[k]->grid.gather(k == 0 ? b : std::span<const Vec3>(levels_[k - 1]->b), levels_[k]->b);
}

void VertexMultigrid::solve_coarsest() const {
  const Level& level = *levels_.back();
  const IndexMap& nodes = level.grid.nodes();
  std::fill(coarsest_values_.begin(), coarsest_values_.end(), 0.0);
  Eigen::Map<Eigen::VectorXd> whole(coarsest_values_.data(), Eigen::Index(coarsest_values_.size()));
  for (Local i = 0; i < nodes.owned; ++i) whole.segment<3>(3 * nodes.global(i)) = level.b[i];
  sum_in_place(mesh_.comm, coarsest_values_);
  coarsest_.solveInPlace(whole);
  for (Local i = 0; i < nodes.owned; ++i) level.x[i] = whole.segment<3>(3 * nodes.global(i));
}

/// From what grid k has in `x` to the vertices.
void VertexMultigrid::rise_from(std::size_t k, std::span<const Vec3> b, std::span<Vec3> x) const {
  for (; k > 0; --k) {
    const Level& finer = *levels_[k - 1];
    std::fill(finer.x.begin(), finer.x.end(), Vec3::Zero());
    levels_[k]->grid.add_spread(levels_[k]->x, finer.x);
    smooth(finer);
  }
  std::fill(x.begin(), x.end(), Vec3::Zero());
  levels_[0]->grid.add_spread(levels_[0]->x, x);
  std::fill(step_.begin(), step_.end(), Vec3::Zero());
  for (int step = 1; step <= vertex_steps; ++step) {
    matrix_->apply(x, product_);
    for (std::size_t i = 0; i < smoother_.size(); ++i) {
      step_[i] = momentum(step) * step_[i] + weight(step) * (smoother_[i] * (b[i] - product_[i]));
      x[i] += step_[i];
    }
  }
}

void VertexMultigrid::smooth(const Level& level) const {
  const SparseRows rows = level.grid.rows();
  std::fill(level.step.begin(), level.step.end(), Vec3::Zero());
  for (int k = 1; k <= grid_steps; ++k) {
    level.grid.halo().update(level.x);
    auto block = level.grid.values().begin();
    for (Local row = 0; row < rows.size(); ++row) {
      Vec3 rest = level.b[row];
      for (const Local column : rows.columns(row)) rest.noalias() -= *block++ * level.x[column];
      level.step[row] = momentum(k) * level.step[row] + weight(k) * (level.smoother[row] * rest);
    }
    for (Local row = 0; row < rows.size(); ++row) level.x[row] += level.step[row];
  }
}

} // namespace taut
