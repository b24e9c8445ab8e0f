#include "src/filters/sap.hpp"

#include "src/constraints/projection_options.hpp"

namespace taut {

Sap::Sap(const Cloth& cloth, const Pattern& pattern, const config::Inextensibility& options)
    : options_(options), step_(cloth, options), slots_(edge_slots(cloth.mesh, pattern)),
      stiffened_mass_(pattern), vertices_(cloth.mesh, pattern, solver_options(options), "stiffness"),
      system_(cloth.mesh, pattern, solver_options(options)),
      no_force_(cloth.mesh.vertices.owned, Vec3::Zero()), momentum_(cloth.mesh.vertices.owned),
      dx_(cloth.mesh.vertices.size()), weight_(cloth.mesh.edges.size()), gap_(cloth.mesh.edges.owned),
      d_mu_(cloth.mesh.edges.size()) {}

FilterReport Sap::apply(const State& start, double dt, const Freedom& freedom, Candidate& candidate) {
  step_.begin(start, dt, freedom, candidate); // where x = x(mu) already
  const FilterReport report = step_.solve(
      "sap", [&](double strain) { return iterate(freedom, strain); }, [] { return true; });
  step_.end(candidate);
  return report;
}

void Sap::weigh_edges() {
  for (std::size_t e = 0; e < weight_.size(); ++e)
    weight_[e] = 2.0 * step_.mu[e] / step_.constraints.cloth().rest_length[e];
}

SolveReport Sap::iterate(const Freedom& freedom, double strain) {
  const EdgeConstraints& c = step_.constraints;
  weigh_edges();
  c.residual(step_.mu, gap_);
  system_.assemble({c.cloth().mass, weight_, c.gradients(), c.scaled_compliance(), &freedom});
  SolveReport report = system_.solve(no_force_, gap_, forcing(strain, options_.strain), dx_, d_mu_);
  if (!report.failure.empty()) return report;
  for (std::size_t e = 0; e < d_mu_.size(); ++e) step_.mu[e] += d_mu_[e];
  const SolveReport moved = move_to_least(freedom);
  return {report.iterations + moved.iterations, moved.failure};
}

/// x <- x(mu).
SolveReport Sap::move_to_least(const Freedom& freedom) {
  constexpr double tolerance = 1e-6; // of the change of x
  const Cloth& cloth = step_.constraints.cloth();
  weigh_edges();
  fill_stiffened_mass(cloth.mesh, slots_, cloth.mass, weight_, stiffened_mass_);
  for (std::size_t i = 0; i < momentum_.size(); ++i) momentum_[i] = cloth.mass[i] * step_.free[i];
  return vertices_.solve(stiffened_mass_, momentum_, freedom, tolerance, step_.x);
}

} // namespace taut
