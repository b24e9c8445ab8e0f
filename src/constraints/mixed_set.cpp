#include "src/constraints/mixed_set.hpp"

#include "src/linear/bounded_qp.hpp"

#include <algorithm>

namespace taut {

MixedSet::MixedSet(const Cloth& cloth, const config::Inextensibility& options, ConstraintUse use)
    : cloth_(cloth), edges_(cloth, options, use, find_threads(cloth.mesh)), metric_(cloth, options, use),
      compliance_(rows()), rhs_(rows()), tolerance_(rows()), change_(rows()),
      push_(cloth.mesh.vertices.size()) {}

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

void MixedSet::multiply(std::span<const double> z, std::span<double> product) {
  const DistributedMesh& mesh = cloth_.mesh;
  std::fill(push_.begin(), push_.end(), Vec3::Zero());
  begin_spread(z);
  end_spread(push_);
  for (Local i = 0; i < mesh.vertices.owned; ++i)
    push_[i] = inverse_mass()[i] * freedom().allowed(i, push_[i]);
  mesh.vertex_halo.update(push_);
  for (std::size_t r = 0; r < product.size(); ++r) product[r] = compliance_[r] * z[r];
  subtract_difference(push_, product);
}

SolveReport MixedSet::solve(double tolerance) {
  constexpr int most_products = 1000;
  factor(inverse_mass());
  residual(rhs_);
  double largest = 0;
  for (const double c : rhs_) largest = std::max(largest, std::abs(c));
  largest = max_over(cloth_.mesh.comm, largest);
  std::fill(change_.begin(), change_.end(), 0.0);
  if (largest == 0) return {};
  std::fill(tolerance_.begin(), tolerance_.end(), tolerance * largest);
  const BoundedQp equations{[this](auto z, auto product) { multiply(z, product); },
                            [this](auto r, auto s) { precondition(r, s); },
                            rhs_,
                            rows(),
                            {},
                            {},
                            tolerance_};
  SolveReport report;
  const QpReport solved = taut::solve(cloth_.mesh.comm, equations, {most_products}, change_);
  report.iterations = solved.products;
  if (!solved.solved) report.failure = "it did not converge";
  add(change_);
  return report;
}

double MixedSet::evaluate(std::span<const Vec3> x) {
  const double strain = std::max(edges_.evaluate(x), metric_.evaluate(x));
  std::copy_n(edges_.program_compliance().begin(), edges_.rows(), compliance_.begin());
  std::copy_n(metric_.program_compliance().begin(), metric_.rows(),
              of_metric(std::span(compliance_)).begin());
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
  edges_.program_residual(of_edges(residual));
  metric_.program_residual(of_metric(residual));
}

void MixedSet::program_tolerance(double part_of_limit, std::span<double> tolerance) const {
  edges_.program_tolerance(part_of_limit, of_edges(tolerance));
  metric_.program_tolerance(part_of_limit, of_metric(tolerance));
}

void MixedSet::program_guess(std::span<double> guess) const {
  edges_.program_guess(of_edges(guess));
  metric_.program_guess(of_metric(guess));
}

void MixedSet::factor(std::span<const double> metric) {
  edges_.factor(metric);
  metric_.factor(metric);
}

void MixedSet::precondition(std::span<const double> r, std::span<double> s) const {
  edges_.precondition(of_edges(r), of_edges(s));
  metric_.precondition(of_metric(r), of_metric(s));
}

void MixedSet::begin_spread(std::span<const double> z) {
  edges_.begin_spread(of_edges(z));
  metric_.begin_spread(of_metric(z));
}

void MixedSet::end_spread(std::span<Vec3> field) {
  edges_.end_spread(field);
  metric_.end_spread(field);
}

void MixedSet::subtract_difference(std::span<const Vec3> u, std::span<double> rows) {
  edges_.subtract_difference(u, of_edges(rows));
  metric_.subtract_difference(u, of_metric(rows));
}

void MixedSet::add(std::span<const double> z) {
  edges_.add(of_edges(z));
  metric_.add(of_metric(z));
}

void MixedSet::residual(std::span<double> rows) const {
  edges_.residual(of_edges(rows));
  metric_.residual(of_metric(rows));
}

void MixedSet::multipliers(std::span<double> rows) const {
  edges_.multipliers(of_edges(rows));
  metric_.multipliers(of_metric(rows));
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
