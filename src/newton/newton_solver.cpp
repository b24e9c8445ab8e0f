#include "src/newton/newton_solver.hpp"

#include "src/constraints/mixed_set.hpp"
#include "src/linear/as_vectors.hpp"
#include "src/state/resolve.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace taut {

namespace {

constexpr double row_tolerance = 0.03; // see README.md
constexpr int most_row_steps = 100;
constexpr int most_with_old_factor = 8;        // iterations
constexpr int most_with_old_factor_untold = 3; // whatever their rate
constexpr int most_stalled = 20;               // iterations in a row, after which there is no solution
constexpr double told_apart = 1e-8;            // of what rows yield, far below what a step asks for
constexpr double part_of_way = 1e-3;           // of what starts from rest; less is lost in what turns

} // namespace

template<ConstraintSetInNewton Set>
NewtonSolver<Set>::NewtonSolver(const Cloth& cloth, const Pattern& pattern, Set& set,
                                SolverOptions::Kind kind)
    : cloth_(cloth), set_(set), row_edges_(set.row_edges()),
      gcr_(cloth.mesh.comm, 3 * std::size_t(cloth.mesh.vertices.owned) + set.rows()),
      total_mass_(mass_of(cloth)), solution_(3 * std::size_t(cloth.mesh.vertices.owned) + set.rows()),
      left_(solution_), source_(solution_), direction_(solution_), product_(solution_), weights_(solution_),
      metric_(cloth.mesh.vertices.size()), tolerance_(set.rows()),
      rows_(set.rows()), room_{rows_, rows_, rows_, rows_}, x_(cloth.mesh.vertices.size()), y_(x_) {
  if (kind == SolverOptions::Kind::mumps)
    factor_.emplace(cloth.mesh, pattern, row_edges_, set.rows());
  else
    coarse_.emplace(cloth.mesh, grids_.emplace(cloth.mesh, pattern), row_edges_, set.row_places());
}

template<ConstraintSetInNewton Set>
void NewtonSolver<Set>::factor(const FilteredOperator& stiffness) {
  stiffness_ = &stiffness;
  find_metric();
  set_.program_tolerance(1.0, tolerance_);
  if (factor_ && (age_ == Age::none || !may_keep_factor_)) return renew_factor();
  age_ = Age::old;
  if (factor_) return;
  grids_->set(stiffness);
  set_.factor(metric_);
  coarse_->set(set_.gradients(), set_.freedom(), set_.program_compliance());
}

/// With a, and a little of what rows yield: those that depend on each other have no factor without.
template<ConstraintSetInNewton Set>
void NewtonSolver<Set>::renew_factor() {
  const auto a = set_.program_compliance();
  const auto weights = std::span(weights_).last(a.size());
  yielding_.resize(a.size());
  for (std::size_t row = 0; row < a.size(); ++row) yielding_[row] = a[row] + told_apart / weights[row];
  factor_->factor(*stiffness_, set_.gradients(), yielding_);
  age_ = Age::current;
}

/// W, and the weights of residuals that go with it: 1/(J W J^T + a) of the rows, their diagonals nearly.
template<ConstraintSetInNewton Set>
void NewtonSolver<Set>::find_metric() {
  const Local owned = cloth_.mesh.vertices.owned;
  stiffness_->inverse_means(metric_);
  for (Local i = 0; i < owned; ++i)
    std::fill_n(weights_.begin() + 3 * i, 3, metric_[i] == 0 ? 1.0 : metric_[i]); // where held: the identity
  std::copy_n(set_.program_compliance().begin(), rows_.size(), rows_.begin());
  for (const auto& [row, edge, factor] : row_edges_) {
    const auto& [a, b] = cloth_.mesh.edge_vertices[edge];
    rows_[row] += factor * factor * set_.gradients()[edge].squaredNorm() * (metric_[a] + metric_[b]);
  }
  for (std::size_t row = 0; row < rows_.size(); ++row)
    weights_[3 * std::size_t(owned) + row] = rows_[row] > 0 ? 1.0 / rows_[row] : 1.0;
}

template<ConstraintSetInNewton Set>
SolveReport NewtonSolver<Set>::solve(std::span<const Vec3> r, std::span<const double> c, const Goal& goal,
                                     int max_iterations, std::vector<Vec3>& dx, std::vector<double>& dmu) {
  const std::size_t n = r.size();
  std::copy(r.begin(), r.end(), as_vectors(left_).begin());
  std::copy(c.begin(), c.end(), left_.begin() + 3 * n);
  std::fill(solution_.begin(), solution_.end(), 0.0);
  gcr_.start(weights_);
  SolveReport report;
  for (bool is_solved = false;
       !is_solved && report.iterations < max_iterations && gcr_.stalled() < most_stalled;) {
    const bool of_left = gcr_.stalled() == 0;
    source_ = of_left ? left_ : product_;
    report.failure = find_direction();
    ++report.iterations;
    if (!report.failure.empty()) break;
    const double movement = rms(as_vectors(direction_));
    if (gcr_.step(direction_, product_, solution_, left_) == 0) break; // no further progress
    const double allowed = allowed_movement(goal);
    is_solved = of_left && movement <= allowed && strain(std::span(left_).subspan(3 * n)) <= goal.strain;
    if (factor_ && age_ == Age::old && !is_solved && !serves(report, movement, allowed)) {
      may_keep_factor_ = false;
      renew_factor();
    }
  }
  std::copy_n(as_vectors(solution_).begin(), n, dx.begin());
  cloth_.mesh.vertex_halo.update(dx);
  for (std::size_t row = 0; row < dmu.size(); ++row) dmu[row] = -solution_[3 * n + row];
  return report;
}

template<ConstraintSetInNewton Set>
double NewtonSolver<Set>::movement(std::span<const Vec3> r) {
  const auto x = as_vectors(direction_).first(r.size());
  if (factor_) {
    std::ranges::fill(source_, 0.0);
    std::ranges::copy(r, as_vectors(source_).begin());
    if (!factor_->solve(source_, direction_).failure.empty()) return HUGE_VAL;
  } else {
    grids_->solve(r, x);
  }
  return rms(x);
}

template<ConstraintSetInNewton Set>
double NewtonSolver<Set>::rms(std::span<const Vec3> field) const {
  double sum = 0;
  for (Local i = 0; i < cloth_.mesh.vertices.owned; ++i) sum += cloth_.mass[i] * field[i].squaredNorm();
  return std::sqrt(sum_over(cloth_.mesh.comm, sum) / total_mass_);
}

template<ConstraintSetInNewton Set>
double NewtonSolver<Set>::allowed_movement(const Goal& goal) {
  const auto x = as_vectors(solution_);
  for (std::size_t i = 0; i < goal.moved.size(); ++i) y_[i] = goal.moved[i] + x[i];
  return std::clamp(part_of_way * rms(y_), goal.least, goal.most);
}

/// Whether a factor of an earlier matrix is worth keeping: at the rate so far, few iterations suffice.
template<ConstraintSetInNewton Set>
bool NewtonSolver<Set>::serves(const SolveReport& report, double movement, double allowed) {
  if (report.iterations == 1) first_movement_ = movement;
  if (report.iterations < most_with_old_factor_untold) return true;
  const double rate = std::pow(movement / first_movement_, 1.0 / (report.iterations - 1));
  return rate < 1 &&
         report.iterations + std::log(allowed / movement) / std::log(rate) <= most_with_old_factor;
}

/// The largest of the linearised constraints, in parts of the strain limit.
template<ConstraintSetInNewton Set>
double NewtonSolver<Set>::strain(std::span<const double> c) const {
  double largest = 0;
  for (std::size_t row = 0; row < c.size(); ++row)
    largest = std::max(largest, std::abs(c[row]) / tolerance_[row]);
  return max_over(cloth_.mesh.comm, largest);
}

/// The preconditioner for `source_`, and its product, in `direction_` and `product_`. Returns why there is
/// none.
template<ConstraintSetInNewton Set>
std::string NewtonSolver<Set>::find_direction() {
  if (!factor_) {
    precondition();
    return "";
  }
  if (const SolveReport solved = factor_->solve(source_, direction_); !solved.failure.empty())
    return solved.failure;
  const auto x = as_vectors(direction_).first(std::size_t(cloth_.mesh.vertices.owned));
  std::copy(x.begin(), x.end(), x_.begin());
  cloth_.mesh.vertex_halo.update(x_);
  begin_product();
  std::copy_n(y_.begin(), x.size(), as_vectors(product_).begin());
  end_product();
  return "";
}

/// The same by grids and projections.
template<ConstraintSetInNewton Set>
void NewtonSolver<Set>::precondition() {
  const DistributedMesh& mesh = cloth_.mesh;
  const auto n = std::size_t(mesh.vertices.owned);
  const auto r = as_vectors(source_).first(n);
  const auto c = std::span(source_).subspan(3 * n), d = std::span(direction_).subspan(3 * n);

  for (std::size_t row = 0; row < c.size(); ++row) rows_[row] = -c[row];
  grids_->restrict_to(coarse_->level(), r, nodes_);
  coarse_->solve(nodes_, rows_, start_, d);
  for (double& m : d) m = -m;

  const auto b = as_vectors(product_).first(n); // r + J^T d
  spread(d);
  for (std::size_t i = 0; i < n; ++i) b[i] = r[i] - stiffness_->freedom().allowed(Local(i), y_[i]);
  const auto x = as_vectors(direction_).first(n);
  grids_->solve(b, coarse_->level(), start_, x);
  project(x);
  std::copy(x.begin(), x.end(), x_.begin());
  mesh.vertex_halo.update(x_);
  choose_multipliers();
}

/// `y_` = -J^T z on owned vertices.
template<ConstraintSetInNewton Set>
void NewtonSolver<Set>::spread(std::span<const double> z) {
  std::fill_n(y_.begin(), cloth_.mesh.vertices.owned, Vec3::Zero());
  set_.begin_spread(z);
  set_.end_spread(y_);
}

/// rows_ <- (J W J^T + a)^-1 rows_, nearly: by a few steps of conjugate gradients, more of them where warp
/// and weft lie along each other, which the set's own inverse does not know.
template<ConstraintSetInNewton Set>
void NewtonSolver<Set>::solve_rows() {
  auto& [x, z, p, q] = room_;
  std::fill(x.begin(), x.end(), 0.0);
  set_.precondition(rows_, z);
  p = z;
  double rz = dot(rows_, z);
  const double enough = row_tolerance * row_tolerance * rz;
  for (int step = 0; step < most_row_steps && rz > enough; ++step) {
    set_.multiply(p, q);
    const double alpha = rz / dot(p, q);
    for (std::size_t row = 0; row < x.size(); ++row) {
      x[row] += alpha * p[row];
      rows_[row] -= alpha * q[row];
    }
    set_.precondition(rows_, z);
    const double before = std::exchange(rz, dot(rows_, z));
    for (std::size_t row = 0; row < x.size(); ++row) p[row] = z[row] + rz / before * p[row];
  }
  std::swap(rows_, x);
}

/// Of rows.
template<ConstraintSetInNewton Set>
double NewtonSolver<Set>::dot(std::span<const double> a, std::span<const double> b) const {
  double sum = 0;
  for (std::size_t row = 0; row < a.size(); ++row) sum += a[row] * b[row];
  return sum_over(cloth_.mesh.comm, sum);
}

/// x -= W J^T z with (J W J^T + a) z = c + J x + a d.
template<ConstraintSetInNewton Set>
void NewtonSolver<Set>::project(std::span<Vec3> x) {
  const auto a = set_.program_compliance();
  const auto c = std::span(source_).subspan(3 * x.size()), d = std::span(direction_).subspan(3 * x.size());
  std::copy(x.begin(), x.end(), x_.begin());
  cloth_.mesh.vertex_halo.update(x_);
  for (std::size_t row = 0; row < rows_.size(); ++row) rows_[row] = -c[row] - a[row] * d[row];
  set_.subtract_difference(x_, rows_);
  solve_rows();
  spread(rows_);
  for (std::size_t i = 0; i < x.size(); ++i)
    x[i] -= metric_[i] * stiffness_->freedom().allowed(Local(i), y_[i]);
}

/// d += e with (J W J^T + a) e = -J W (b - H x), for the displacements `x_` and b where the product's first
/// part comes to be; then the product of both.
template<ConstraintSetInNewton Set>
void NewtonSolver<Set>::choose_multipliers() {
  const auto b = as_vectors(product_).first(std::size_t(cloth_.mesh.vertices.owned));
  const auto d = std::span(direction_).subspan(3 * b.size());
  begin_product();
  for (std::size_t i = 0; i < b.size(); ++i) {
    x_[i] = metric_[i] * (b[i] - y_[i]);
    b[i] = y_[i];
  }
  cloth_.mesh.vertex_halo.update(x_);
  std::fill(rows_.begin(), rows_.end(), 0.0);
  set_.subtract_difference(x_, rows_);
  solve_rows();
  for (std::size_t row = 0; row < rows_.size(); ++row) d[row] += rows_[row];
  end_product();
}

/// What the displacements `x_` do: H x in `y_`, -J x in the rows of `product_`.
template<ConstraintSetInNewton Set>
void NewtonSolver<Set>::begin_product() {
  const auto p = std::span(product_).subspan(3 * std::size_t(cloth_.mesh.vertices.owned));
  std::fill(p.begin(), p.end(), 0.0);
  set_.subtract_difference(x_, p);
  stiffness_->matrix().multiply(x_, y_);
  for (Local i = 0; i < cloth_.mesh.vertices.owned; ++i) y_[i] = stiffness_->freedom().allowed(i, y_[i]);
}

/// Adds to `product_` what the multipliers of `direction_` do.
template<ConstraintSetInNewton Set>
void NewtonSolver<Set>::end_product() {
  const auto n = std::size_t(cloth_.mesh.vertices.owned);
  const auto d = std::span(direction_).subspan(3 * n), p = std::span(product_).subspan(3 * n);
  const auto a = set_.program_compliance();
  for (std::size_t row = 0; row < d.size(); ++row) p[row] -= a[row] * d[row];
  spread(d);
  const auto b = as_vectors(product_);
  for (std::size_t i = 0; i < n; ++i) b[i] += stiffness_->freedom().allowed(Local(i), y_[i]);
}

template class NewtonSolver<EdgeSet>;
template class NewtonSolver<MetricSet>;
template class NewtonSolver<MixedSet>;

} // namespace taut
