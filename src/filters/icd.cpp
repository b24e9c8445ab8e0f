#include "src/filters/icd.hpp"

#include "src/constraints/projection_options.hpp"

#include <algorithm>
#include <cmath>

namespace taut {

namespace {

double shortest_edge(const Cloth& cloth) {
  double shortest = HUGE_VAL;
  for (const double l : cloth.rest_length) shortest = std::min(shortest, l);
  return -max_over(cloth.mesh.comm, -shortest);
}

} // namespace

Icd::Icd(const Cloth& cloth, const Pattern& pattern, const config::Inextensibility& options)
    : options_(options), step_(cloth, options), system_(cloth.mesh, pattern, solver_options(options)),
      shortest_(shortest_edge(cloth)), force_(cloth.mesh.vertices.owned), dx_(cloth.mesh.vertices.size()),
      weight_(cloth.mesh.edges.size()), gap_(cloth.mesh.edges.owned), d_mu_(cloth.mesh.edges.size()) {}

FilterReport Icd::apply(const State& start, double dt, const Freedom& freedom, Candidate& candidate) {
  step_.begin(start, dt, freedom, candidate);
  const FilterReport report = step_.solve(
      "icd", [&](double strain) { return iterate(freedom, strain); },
      [&] { return force_residual() <= options_.strain * shortest_; });
  step_.end(candidate);
  return report;
}

/// -F into `force_`; returns max |F_i|/m_i over all ranks.
double Icd::force_residual() {
  const EdgeConstraints& c = step_.constraints;
  const std::vector<double>& mass = c.cloth().mass;
  double max = 0;
  for (std::size_t i = 0; i < force_.size(); ++i) {
    force_[i].setZero();
    if (!step_.is_free(Local(i))) continue;
    force_[i] = mass[i] * (step_.free[i] - step_.x[i]) - c.pull(Local(i), c.gradients(), step_.mu);
    max = std::max(max, force_[i].norm() / mass[i]);
  }
  return max_over(step_.mesh().comm, max);
}

SolveReport Icd::iterate(const Freedom& freedom, double strain) {
  const EdgeConstraints& c = step_.constraints;
  const bool exact = options_.solver == config::LinearSolver::mumps;
  for (std::size_t e = 0; e < weight_.size(); ++e)
    weight_[e] = 2.0 * (exact ? step_.mu[e] : std::max(step_.mu[e], 0.0)) / c.cloth().rest_length[e];
  force_residual();
  c.residual(step_.mu, gap_);
  system_.assemble({c.cloth().mass, weight_, c.gradients(), c.scaled_compliance(), &freedom});
  const SolveReport solved = system_.solve(force_, gap_, forcing(strain, options_.strain), dx_, d_mu_);
  for (std::size_t i = 0; i < dx_.size(); ++i) step_.x[i] += dx_[i];
  for (std::size_t e = 0; e < d_mu_.size(); ++e) step_.mu[e] += d_mu_[e];
  return solved;
}

} // namespace taut
