#include "src/constraints/metric_set.hpp"

#include "src/constraints/edge_loops.hpp"
#include "src/constraints/projection_options.hpp"
#include "src/constraints/strain_gauge.hpp"
#include "src/state/inverse_mass.hpp"

#include <algorithm>
#include <cmath>

namespace taut {

MetricSet::MetricSet(const Cloth& cloth, const config::Inextensibility& options, ConstraintUse use)
    : cloth_(cloth), options_(options), use_(use), bounds_(compliance_bounds(options, use)), metric_(cloth),
      inverse_mass_(cloth.mesh.vertices.size()), gradients_(cloth.mesh.edges.size()),
      metrics_(cloth.mesh.vertices.owned, Vec2::Zero()), residual_(metrics_), scaled_compliance_(metrics_),
      change_(cloth.mesh.vertices.size()), mu_(change_), edge_values_(cloth.mesh.edges.size()) {
  for (Local i = 0; i < cloth.mesh.vertices.size(); ++i)
    scale_.push_back(metric_.has(i) ? std::sqrt(metric_.area(i)) : 1.0);
  find_columns();
  using Preconditioner = MetricSystem::Preconditioner;
  system_.emplace(cloth.mesh, column_begin_, column_rows_, options_of_system(),
                  use == ConstraintUse::with_contact ? Preconditioner::sweep : Preconditioner::multigrid);
}

void MetricSet::find_columns() {
  for (Local p = 0; p < cloth_.mesh.vertices.owned; ++p) {
    const std::size_t first = column_rows_.size();
    for (const EdgeEnd& end : cloth_.mesh.star_of(p))
      for (const auto& share : metric_.of_edge(end.edge)) {
        const auto begin = column_rows_.begin() + std::ptrdiff_t(first);
        const auto found = std::find(begin, column_rows_.end(), share.vertex);
        const auto place = std::size_t(found - column_rows_.begin());
        if (place == column_rows_.size()) column_rows_.push_back(share.vertex);
        entries_.push_back({end, scale_[share.vertex] * share.weight, place});
      }
    column_begin_.push_back(column_rows_.size());
  }
  columns_.resize(column_rows_.size());
}

/// The rows nearly depend on each other, and what preconditions Newton's method need not be exact: there they
/// are factored, with a compliance that makes their factor one of a regular matrix.
SolverOptions MetricSet::options_of_system() const {
  if (use_ != ConstraintUse::in_newton) return solver_options(options_);
  return {.kind = SolverOptions::Kind::mumps};
}

void MetricSet::start(const State& start, double dt, const Freedom& freedom, const Candidate&) {
  dt_ = dt;
  start_ = &start;
  freedom_ = freedom;
  take_inverse_masses(cloth_, freedom, inverse_mass_);
  for (std::size_t i = 0; i < mu_.size(); ++i)
    mu_[i] = options_.carried_tension ? Vec2(0.5 * dt * dt * scale_[i] * start.multipliers.stress[i])
                                      : Vec2(Vec2::Zero());
}

double MetricSet::evaluate(std::span<const Vec3> x) {
  const DistributedMesh& mesh = cloth_.mesh;
  for (std::size_t e = 0; e < gradients_.size(); ++e) {
    const auto& [a, b] = mesh.edge_vertices[e];
    gradients_[e] = 2.0 * (x[b] - x[a]);
  }
  double max = 0;
  for (Local i = 0; i < mesh.vertices.owned; ++i) {
    if (!metric_.has(i)) continue;
    metrics_[i] = metric_.at(i, x);
    for (const double g : metrics_[i]) {
      const double strain = std::abs(std::sqrt(g) - 1.0);
      max = std::max(max, std::isfinite(strain) ? strain : HUGE_VAL);
    }
  }
  take_compliances();
  return max_over(mesh.comm, max);
}

double MetricSet::strain(std::span<const Vec3> x) const { return largest_strain(metric_, x); }

void MetricSet::fill_columns() {
  for (auto& column : columns_) column.fill(Vec3::Zero());
  for (const auto& [end, weight, place] : entries_) {
    const Vec3 g = end.sign * gradients_[end.edge];
    for (int k = 0; k < 2; ++k) columns_[place][k] += weight[k] * g;
  }
}

/// Whether any motion that is free changes the metric at an owned vertex.
bool MetricSet::can_change(Local vertex) const {
  const auto shares = metric_.of_vertex(vertex);
  return std::any_of(shares.begin(), shares.end(), [&](const auto& share) {
    const auto& [a, b] = cloth_.mesh.edge_vertices[share.edge];
    const Vec3& side = gradients_[share.edge];
    return !freedom_.allowed(a, side).isZero(0) || !freedom_.allowed(b, side).isZero(0);
  });
}

void MetricSet::take_compliances() {
  for (Local i = 0; i < cloth_.mesh.vertices.owned; ++i)
    for (int k = 0; k < 2; ++k) scaled_compliance_[i][k] = can_change(i) ? yield_at(i, mu_[i][k]).slope : 1.0;
}

/// Of warp or weft at an owned vertex.
Yield MetricSet::yield_at(Local vertex, double mu) const {
  const double asked = 4.0 * options_.compliance.value_or(0.0) * scale_[vertex] / (dt_ * dt_);
  const double by_mass = 4.0 * inverse_mass_around(vertex); // about J W J^T of a row whose metric is 1
  return yield(std::min(asked, bounds_.part * by_mass), mu, 2 * scale_[vertex] * bounds_.strain);
}

/// Of a vertex; if it is held, the largest of its neighbours: their motion changes the metric there.
double MetricSet::inverse_mass_around(Local vertex) const {
  double result = inverse_mass_[vertex];
  if (result > 0) return result;
  for (const EdgeEnd& end : cloth_.mesh.star_of(vertex)) result = std::max(result, inverse_mass_[end.other]);
  return result;
}

void MetricSet::factor(std::span<const double> metric) {
  fill_columns();
  if (use_ != ConstraintUse::in_newton) {
    system_->assemble(columns_, metric, freedom_, scaled_compliance_);
    return;
  }
  constexpr double part = 1e-5; // of what a row yields
  std::vector<Vec2> compliance = scaled_compliance_;
  for (std::size_t i = 0; i < compliance.size(); ++i) compliance[i].array() += part * 4.0 * metric[i];
  system_->assemble(columns_, metric, freedom_, compliance);
}

SolveReport MetricSet::solve(double tolerance) {
  factor(inverse_mass_);
  residual({reinterpret_cast<double*>(residual_.data()), rows()});
  SolveReport report = system_->solve(residual_, tolerance, change_);
  if (!report.failure.empty()) return report;
  add_change();
  return report;
}

void MetricSet::residual(std::span<double> rows) const {
  for (Local i = 0; i < cloth_.mesh.vertices.owned; ++i) {
    for (int k = 0; k < 2; ++k)
      rows[2 * i + k] =
          can_change(i) ? scale_[i] * (metrics_[i][k] - 1.0) - yield_at(i, mu_[i][k]).length : 0.0;
  }
}

/// By squared length, of local edges: what J^T makes of `values`, but for the edges' own derivatives.
void MetricSet::spread_to_edges(std::span<const Vec2> values, std::span<double> on_edges) const {
  for (Local e = 0; e < cloth_.mesh.edges.size(); ++e) on_edges[e] = metric_.on_edge(e, scale_, values);
}

void MetricSet::tension_weights(std::span<double> weights) const {
  spread_to_edges(mu_, weights);
  for (double& w : weights) w = 2.0 * std::abs(w);
}

void MetricSet::multipliers(std::span<double> rows) const {
  std::copy_n(reinterpret_cast<const double*>(mu_.data()), rows.size(), rows.begin());
}

std::vector<RowEdge> MetricSet::row_edges() const {
  std::vector<RowEdge> result;
  for (Local i = 0; i < cloth_.mesh.vertices.owned; ++i)
    for (const auto& share : metric_.of_vertex(i))
      for (int k = 0; k < 2; ++k)
        result.push_back({std::size_t(2 * i + k), share.edge, scale_[i] * share.weight[k]});
  return result;
}

/// The weights of a row make u u^T of the sides d, as sum w d d^T.
std::vector<RowPlace> MetricSet::row_places() const {
  const auto& rest = cloth_.mesh.rest_positions;
  std::vector<RowPlace> result;
  for (Local i = 0; i < cloth_.mesh.vertices.owned; ++i)
    for (int k = 0; k < 2; ++k) {
      Mat3 sum = Mat3::Zero();
      for (const auto& share : metric_.of_vertex(i)) {
        const auto& [a, b] = cloth_.mesh.edge_vertices[share.edge];
        sum += share.weight[k] * (rest[b] - rest[a]) * (rest[b] - rest[a]).transpose();
      }
      Eigen::Index longest = 0;
      sum.diagonal().maxCoeff(&longest);
      result.push_back({rest[i], sum.col(longest).normalized(), metric_.has(i) ? scale_[i] : 0.0});
    }
  return result;
}

void MetricSet::add_change() {
  for (std::size_t i = 0; i < mu_.size(); ++i) mu_[i] += change_[i];
  spread_to_edges(change_, edge_values_); // for `displacement`
}

Vec3 MetricSet::displacement(Local vertex) const {
  return inverse_mass_[vertex] *
         freedom_.allowed(vertex, sum_at(cloth_.mesh, vertex, gradients_, edge_values_));
}

void MetricSet::store_stress(Candidate& candidate) const {
  for (std::size_t i = 0; i < mu_.size(); ++i)
    candidate.multipliers.stress[i] = 2.0 / (dt_ * dt_ * scale_[i]) * mu_[i];
}

void MetricSet::force_densities(std::span<double> on_edges) const {
  spread_to_edges(mu_, on_edges);
  for (double& q : on_edges) q *= 2.0 / (dt_ * dt_);
}

void MetricSet::finish_beside_edges(Candidate& candidate) const {
  std::vector<double> own(edge_values_.size());
  force_densities(own);
  std::vector<double>& all = candidate.multipliers.force_density;
  for (std::size_t e = 0; e < own.size(); ++e) all[e] += own[e];
  store_stress(candidate);
  cloth_.mesh.edge_halo.update(all);
}

void MetricSet::finish(Candidate& candidate) const {
  store_stress(candidate);
  std::vector<double>& force_density = candidate.multipliers.force_density;
  force_densities(force_density);
  // an edge far from owned vertices lacks triangles
  cloth_.mesh.edge_halo.update(force_density);
}

void MetricSet::keep_strain(double part) { strain_kept_ = part; }

void MetricSet::program_residual(std::span<double> residual) const {
  constexpr double most_kept = 0.6; // of the limit
  const double most = most_kept * options_.strain;
  for (Local i = 0; i < cloth_.mesh.vertices.owned; ++i) {
    const Vec2 kept =
        strain_kept_ > 0
            ? Vec2(
                  strain_kept_ *
                  (metric_.at(i, start_->positions).cwiseSqrt().array() - 1.0).cwiseMax(-most).cwiseMin(most))
            : Vec2(Vec2::Zero());
    for (int k = 0; k < 2; ++k) {
      const double length = std::sqrt(metrics_[i][k]);
      const double value = 2 * scale_[i] * length * (length - 1 - kept[k]);
      residual[2 * i + k] = can_change(i) ? value - yield_at(i, mu_[i][k]).length : 0.0;
    }
  }
}

void MetricSet::program_tolerance(double part_of_limit, std::span<double> tolerance) const {
  for (std::size_t r = 0; r < tolerance.size(); ++r)
    tolerance[r] = part_of_limit * options_.strain * 2.0 * scale_[r / 2];
}

/// The last step's multipliers are in the prediction; of its programs nothing is known.
void MetricSet::program_guess(std::span<double> guess) const { std::fill(guess.begin(), guess.end(), 0.0); }

void MetricSet::take_rows(std::span<const double> rows) {
  for (std::size_t r = 0; r < rows.size(); ++r) change_[r / 2][Eigen::Index(r % 2)] = rows[r];
}

void MetricSet::begin_spread(std::span<const double> z) {
  take_rows(z);
  cloth_.mesh.vertex_halo.begin_update(change_);
}

void MetricSet::end_spread(std::span<Vec3> field) {
  cloth_.mesh.vertex_halo.end_update(change_);
  spread_to_edges(change_, edge_values_);
  subtract_spread(cloth_.mesh, gradients_, edge_values_, field);
}

void MetricSet::subtract_difference(std::span<const Vec3> u, std::span<double> rows) {
  for (std::size_t e = 0; e < edge_values_.size(); ++e)
    edge_values_[e] = difference(cloth_.mesh, gradients_, u, e);
  for (Local i = 0; i < cloth_.mesh.vertices.owned; ++i) {
    Vec2 sum = Vec2::Zero();
    for (const auto& share : metric_.of_vertex(i)) sum += edge_values_[share.edge] * share.weight;
    for (int k = 0; k < 2; ++k) rows[2 * i + k] -= scale_[i] * sum[k];
  }
}

void MetricSet::add(std::span<const double> z) {
  take_rows(z);
  cloth_.mesh.vertex_halo.update(change_);
  add_change();
}

} // namespace taut
