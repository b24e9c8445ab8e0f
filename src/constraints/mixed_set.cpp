#include "src/constraints/mixed_set.hpp"

#include "src/constraints/solve_matrix_free.hpp"

#include <algorithm>

namespace taut {

MixedSet::MixedSet(const Cloth& cloth, const config::Inextensibility& options, ConstraintUse use)
    : cloth_(cloth), edges_(cloth, options, use, find_threads(cloth.mesh)), metric_(cloth, options, use),
      compliance_(rows()), push_(cloth.mesh.vertices.size()) {}

/// What the candidate carries is the tension of both.
void MixedSet::start(const State& start, double dt, const Freedom& freedom, const Candidate& candidate) {
  metric_.start(start, dt, freedom, candidate);
  edges_.start(start, dt, freedom, candidate);
  std::vector<double> of_metric_rows(cloth_.mesh.edges.size());
  metric_.force_densities(of_metric_rows);
  edges_.subtract_force_densities(of_metric_rows);
}

void MixedSet::finish(Candidate& candidate) const {
  edges_.finish(candidate);
  metric_.finish_beside_edges(candidate);
}

SolveReport MixedSet::solve(double tolerance) { return solve_matrix_free(cloth_.mesh, *this, tolerance); }

double MixedSet::evaluate(std::span<const Vec3> x) {
  const double strain = std::max(edges_.evaluate(x), metric_.evaluate(x));
  std::copy_n(edges_.program_compliance().begin(), edges_.rows(), compliance_.begin());
  std::copy_n(metric_.program_compliance().begin(), metric_.rows(),
              parts().of_second(std::span(compliance_)).begin());
  return strain;
}

Vec3 MixedSet::displacement(Local vertex) const {
  return edges_.displacement(vertex) + metric_.displacement(vertex);
}

void MixedSet::keep_strain(double part) {
  edges_.keep_strain(part);
  metric_.keep_strain(part);
}

void MixedSet::program_residual(std::span<double> residual) const {
  edges_.program_residual(parts().of_first(residual));
  metric_.program_residual(parts().of_second(residual));
}

void MixedSet::program_tolerance(double part_of_limit, std::span<double> tolerance) const {
  edges_.program_tolerance(part_of_limit, parts().of_first(tolerance));
  metric_.program_tolerance(part_of_limit, parts().of_second(tolerance));
}

void MixedSet::program_guess(std::span<double> guess) const {
  edges_.program_guess(parts().of_first(guess));
  metric_.program_guess(parts().of_second(guess));
}

void MixedSet::factor(std::span<const double> metric) {
  inverse_metric_.assign(metric.begin(), metric.end());
  edges_.factor(metric);
  metric_.factor(metric);
}

void MixedSet::multiply(std::span<const double> z, std::span<double> product) {
  multiply_matrix_free(cloth_.mesh, *this, inverse_metric_, z, product, push_);
}

void MixedSet::precondition(std::span<const double> r, std::span<double> s) const {
  edges_.precondition(parts().of_first(r), parts().of_first(s));
  metric_.precondition(parts().of_second(r), parts().of_second(s));
}

void MixedSet::begin_spread(std::span<const double> z) {
  edges_.begin_spread(parts().of_first(z));
  metric_.begin_spread(parts().of_second(z));
}

void MixedSet::end_spread(std::span<Vec3> field) {
  edges_.end_spread(field);
  metric_.end_spread(field);
}

void MixedSet::subtract_difference(std::span<const Vec3> u, std::span<double> rows) {
  edges_.subtract_difference(u, parts().of_first(rows));
  metric_.subtract_difference(u, parts().of_second(rows));
}

void MixedSet::add(std::span<const double> z) {
  edges_.add(parts().of_first(z));
  metric_.add(parts().of_second(z));
}

void MixedSet::residual(std::span<double> rows) const {
  edges_.residual(parts().of_first(rows));
  metric_.residual(parts().of_second(rows));
}

void MixedSet::multipliers(std::span<double> rows) const {
  edges_.multipliers(parts().of_first(rows));
  metric_.multipliers(parts().of_second(rows));
}

/// At least as much as their sum adds.
void MixedSet::tension_weights(std::span<double> weights) const {
  std::vector<double> of_metric_rows(weights.size());
  edges_.tension_weights(weights);
  metric_.tension_weights(of_metric_rows);
  for (std::size_t e = 0; e < weights.size(); ++e) weights[e] += of_metric_rows[e];
}

/// The set's gradients are 2 d, those of an edge's row 2 d/l.
std::vector<RowEdge> MixedSet::row_edges() const {
  std::vector<RowEdge> result;
  for (const RowEdge& r : edges_.row_edges())
    if (edges_.has(r.edge)) result.push_back({r.row, r.edge, 1.0 / cloth_.rest_length[r.edge]});
  for (RowEdge r : metric_.row_edges()) {
    r.row += edges_.rows();
    result.push_back(r);
  }
  return result;
}

std::vector<RowPlace> MixedSet::row_places() const {
  std::vector<RowPlace> result = edges_.row_places();
  const std::vector<RowPlace> behind = metric_.row_places();
  result.insert(result.end(), behind.begin(), behind.end());
  return result;
}

} // namespace taut
