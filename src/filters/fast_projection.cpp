#include "src/filters/fast_projection.hpp"

#include "src/filters/solver_options.hpp"

#include <fmt/format.h>

#include <cmath>

namespace taut {

FastProjection::FastProjection(const Cloth& cloth, const config::Inextensibility& options, double weight)
    : cloth_(cloth), options_(options), constraints_(cloth, options, weight),
      system_(cloth.mesh, solver_options(options)), positions_(cloth.mesh.vertices.size()),
      residual_(cloth.mesh.edges.owned), change_(cloth.mesh.edges.size()), mu_(cloth.mesh.edges.size()) {}

FilterReport FastProjection::apply(const State& start, double dt, const Freedom& freedom,
                                   Candidate& candidate) {
  FilterReport report;
  constraints_.start(dt, freedom);
  constraints_.to_mu(candidate.force_density, mu_);
  for (;; ++report.iterations) {
    for (std::size_t i = 0; i < positions_.size(); ++i)
      positions_[i] = start.positions[i] + dt * candidate.velocities[i];
    const double strain = constraints_.evaluate(positions_);
    if (strain <= options_.strain && report.iterations > 0) break;
    if (!std::isfinite(strain) || report.iterations == options_.max_iterations) {
      report.failure = fmt::format("fast projection left a strain of {:.3g} after {} iterations (limit {:g})",
                                   strain, report.iterations, options_.strain);
      break;
    }
    system_.assemble(constraints_.gradients(), constraints_.inverse_mass(), freedom, constraints_.shift());
    constraints_.residual(mu_, residual_);
    const SolveReport solved = system_.solve(residual_, forcing(strain, options_.strain), change_);
    report.linear_iterations += solved.iterations;
    if (!solved.failure.empty()) {
      report.failure = "the projection's linear solver failed: " + solved.failure;
      break;
    }
    correct(dt, candidate);
  }
  constraints_.to_force_density(mu_, candidate.force_density);
  return report;
}

/// v <- v - W J^T d_mu / h: each owned vertex gathers from its star.
void FastProjection::correct(double dt, Candidate& candidate) {
  for (Local i = 0; i < cloth_.mesh.vertices.owned; ++i)
    candidate.velocities[i] -=
        constraints_.inverse_mass()[i] / dt * constraints_.pull(i, constraints_.gradients(), change_);
  cloth_.mesh.vertex_halo.update(candidate.velocities);
  for (std::size_t e = 0; e < mu_.size(); ++e) mu_[e] += change_[e];
}

} // namespace taut
