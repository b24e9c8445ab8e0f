#include "src/filters/shake.hpp"

#include "src/constraints/projection_options.hpp"

namespace taut {

namespace {

SolverOptions nonsymmetric(const config::Inextensibility& options) {
  SolverOptions result = solver_options(options);
  result.matrix = SolverOptions::Matrix::nonsymmetric;
  return result;
}

} // namespace

Shake::Shake(const Cloth& cloth, const config::Inextensibility& options)
    : options_(options), step_(cloth, options), system_(cloth.mesh, nonsymmetric(options)),
      gap_(cloth.mesh.edges.owned), d_mu_(cloth.mesh.edges.size()) {}

FilterReport Shake::apply(const State& start, double dt, const Freedom& freedom, Candidate& candidate) {
  return apply("shake", start, dt, freedom, candidate);
}

FilterReport Shake::apply(std::string_view method, const State& start, double dt, const Freedom& freedom,
                          Candidate& candidate) {
  step_.begin(start, dt, freedom, candidate);
  step_.constraints.evaluate(start.positions);
  start_gradients_ = step_.constraints.gradients();
  step_.x = step_.free;
  step_.pull(start_gradients_, step_.mu);
  last_strain_ = 0;
  FilterReport report = step_.solve(
      method, [&](double strain) { return iterate(strain); }, [] { return true; });
  if (!report.failure.empty())
    report.failure +=
        "; the edges turned or changed too much for tension along their directions at the start of "
        "the step: take smaller steps, or method icd";
  step_.end(candidate);
  return report;
}

SolveReport Shake::iterate(double strain) {
  const EdgeConstraints& c = step_.constraints;
  const bool lagged = options_.shake.value_or(config::Shake{}).matrix == config::ShakeMatrix::lagged;
  if (!lagged || last_strain_ == 0 || strain > 0.5 * last_strain_)
    system_.assemble(c.gradients(), start_gradients_, c.inverse_mass(), c.freedom(), c.scaled_compliance());
  last_strain_ = strain;
  c.residual(step_.mu, gap_);
  const SolveReport solved = system_.solve(gap_, forcing(strain, options_.strain), d_mu_);
  step_.pull(start_gradients_, d_mu_);
  for (std::size_t e = 0; e < d_mu_.size(); ++e) step_.mu[e] += d_mu_[e];
  return solved;
}

} // namespace taut
