#include "src/filters/metric_rows.hpp"

#include "src/filters/edge_constraints.hpp"
#include "src/filters/solver_options.hpp"

#include <algorithm>
#include <cmath>

namespace taut {

MetricSet::MetricSet(const Cloth& cloth, const config::Inextensibility& options, double weight)
    : cloth_(cloth), metric_(cloth), carries_tension_(options.carried_tension),
      compliance_(compliance_of(options, weight)), inverse_mass_(cloth.mesh.vertices.size()),
      sides_(cloth.mesh.edges.size()), values_(cloth.mesh.vertices.owned), residual_(values_),
      scaled_compliance_(values_), change_(cloth.mesh.vertices.size()), mu_(change_),
      edge_change_(cloth.mesh.edges.size()), edge_sum_(edge_change_) {
  for (const double area : cloth.measure) scale_.push_back(std::sqrt(area));
  find_columns();
  system_.emplace(cloth.mesh, column_begin_, column_rows_, solver_options(options));
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

void MetricSet::start(const State& start, double dt, const Freedom& freedom, const Candidate&) {
  dt_ = dt;
  freedom_ = freedom;
  for (std::size_t i = 0; i < mu_.size(); ++i) {
    inverse_mass_[i] = freedom.is_held(Local(i)) ? 0.0 : 1.0 / cloth_.mass[i];
    mu_[i] = carries_tension_ ? Vec2(0.5 * dt * dt * scale_[i] * start.multipliers.stress[i].cwiseMax(0.0))
                              : Vec2(Vec2::Zero());
  }
  edge_sum_.assign(edge_sum_.size(), 0.0);
}

double MetricSet::evaluate(std::span<const Vec3> x) {
  const DistributedMesh& mesh = cloth_.mesh;
  for (std::size_t e = 0; e < sides_.size(); ++e) {
    const auto& [a, b] = mesh.edge_vertices[e];
    sides_[e] = x[b] - x[a];
  }
  double max = 0;
  for (Local i = 0; i < mesh.vertices.owned; ++i) {
    const Vec2 metric = metric_.at(i, x);
    values_[i] = scale_[i] * (metric.array() - 1.0);
    for (const double g : metric) {
      const double strain = std::abs(std::sqrt(g) - 1.0);
      max = std::max(max, std::isfinite(strain) ? strain : HUGE_VAL);
    }
  }
  return max_over(mesh.comm, max);
}

void MetricSet::fill_columns() {
  for (auto& column : columns_) column.fill(Vec3::Zero());
  for (const auto& [end, weight, place] : entries_) {
    const Vec3 g = 2.0 * end.sign * sides_[end.edge];
    for (int k = 0; k < 2; ++k) columns_[place][k] += weight[k] * g;
  }
}

/// Whether any motion that is free changes the metric at an owned vertex.
bool MetricSet::can_change(Local vertex) const {
  const auto shares = metric_.of_vertex(vertex);
  return std::any_of(shares.begin(), shares.end(), [&](const auto& share) {
    const auto& [a, b] = cloth_.mesh.edge_vertices[share.edge];
    const Vec3& side = sides_[share.edge];
    return !freedom_.allowed(a, side).isZero(0) || !freedom_.allowed(b, side).isZero(0);
  });
}

SolveReport MetricSet::solve(double tolerance) {
  const DistributedMesh& mesh = cloth_.mesh;
  for (Local i = 0; i < mesh.vertices.owned; ++i) {
    const bool free = can_change(i);
    const double a = 4.0 * compliance_ * scale_[i] / (dt_ * dt_);
    scaled_compliance_[i].setConstant(free ? a : 1.0);
    residual_[i] = free ? Vec2(values_[i] - a * mu_[i]) : Vec2(Vec2::Zero());
  }
  fill_columns();
  system_->assemble(columns_, inverse_mass_, freedom_, scaled_compliance_);
  SolveReport report = system_->solve(residual_, tolerance, change_);
  if (!report.failure.empty()) return report;
  for (std::size_t i = 0; i < mu_.size(); ++i) mu_[i] += change_[i];
  for (Local e = 0; e < mesh.edges.size(); ++e) {
    edge_change_[e] = 0;
    for (const auto& share : metric_.of_edge(e))
      edge_change_[e] += scale_[share.vertex] * share.weight.dot(change_[share.vertex]);
    edge_sum_[e] += edge_change_[e];
  }
  return report;
}

Vec3 MetricSet::pulled(Local vertex) const {
  Vec3 pull = Vec3::Zero();
  for (const EdgeEnd& end : cloth_.mesh.star_of(vertex))
    pull += 2.0 * end.sign * edge_change_[end.edge] * sides_[end.edge];
  return inverse_mass_[vertex] * freedom_.allowed(vertex, pull);
}

void MetricSet::finish(Candidate& candidate) const {
  for (std::size_t i = 0; i < mu_.size(); ++i)
    candidate.multipliers.stress[i] = 2.0 / (dt_ * dt_ * scale_[i]) * mu_[i];
  for (std::size_t e = 0; e < edge_sum_.size(); ++e)
    candidate.multipliers.force_density[e] += 2.0 / (dt_ * dt_) * edge_sum_[e];
  cloth_.mesh.edge_halo.update(
      candidate.multipliers.force_density); // an edge far from owned vertices lacks triangles
}

} // namespace taut
