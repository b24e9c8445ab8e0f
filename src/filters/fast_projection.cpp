#include "src/filters/fast_projection.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace taut {

namespace {

SolverOptions solver_options(const config::Inextensibility& options) {
  return {options.solver == config::LinearSolver::mumps ? SolverOptions::Kind::mumps
                                                        : SolverOptions::Kind::cg,
          1000};
}

double default_compliance(double limit, double weight) {
  return weight > 0 ? 4.9 * std::pow(0.1 * limit, 1.5) / weight : 0.0;
}

/// How tightly an iteration is solved: no tighter than what is left to do asks for (inexact Newton).
double forcing(double strain, double limit) { return std::clamp(0.1 * limit / strain, 1e-4, 1e-2); }

} // namespace

FastProjection::FastProjection(const Cloth& cloth, const config::Inextensibility& options, double weight)
    : cloth_(cloth), options_(options),
      compliance_(options.compliance.value_or(default_compliance(options.strain, weight))),
      system_(cloth.mesh, solver_options(options)), positions_(cloth.mesh.vertices.size()),
      gradient_(cloth.mesh.edges.size()), inverse_mass_(cloth.mesh.vertices.size()),
      shift_(cloth.mesh.edges.owned), residual_(cloth.mesh.edges.owned), change_(cloth.mesh.edges.size()),
      mu_(cloth.mesh.edges.size()) {}

FilterReport FastProjection::apply(const State& start_state, double dt, const Freedom& freedom,
                                   Candidate& candidate) {
  FilterReport report;
  start(dt, freedom, candidate);
  for (;; ++report.iterations) {
    for (std::size_t i = 0; i < positions_.size(); ++i)
      positions_[i] = start_state.positions[i] + dt * candidate.velocities[i];
    const double strain = evaluate(freedom);
    if (strain <= options_.strain && report.iterations > 0) break;
    if (!std::isfinite(strain) || report.iterations == options_.max_iterations) {
      report.failure = fmt::format("fast projection left a strain of {:.3g} after {} iterations (limit {:g})",
                                   strain, report.iterations, options_.strain);
      break;
    }
    system_.assemble(gradient_, inverse_mass_, freedom, shift_);
    const SolveReport solved = system_.solve(residual_, forcing(strain, options_.strain), change_);
    report.linear_iterations += solved.iterations;
    if (!solved.failure.empty()) {
      report.failure = "the projection's linear solver failed: " + solved.failure;
      break;
    }
    correct(dt, freedom, candidate);
  }
  for (std::size_t e = 0; e < mu_.size(); ++e)
    candidate.force_density[e] = 2.0 * mu_[e] / (cloth_.rest_length[e] * dt * dt);
  return report;
}

void FastProjection::start(double dt, const Freedom& freedom, const Candidate& candidate) {
  for (Local i = 0; i < Local(inverse_mass_.size()); ++i)
    inverse_mass_[i] = freedom.is_held(i) ? 0.0 : 1.0 / cloth_.mass[i];
  for (std::size_t e = 0; e < shift_.size(); ++e)
    shift_[e] = 4.0 * cloth_.rest_length[e] * compliance_ / (dt * dt);
  for (std::size_t e = 0; e < mu_.size(); ++e)
    mu_[e] = 0.5 * candidate.force_density[e] * cloth_.rest_length[e] * dt * dt;
}

/// Gradients and right-hand side at `positions_`; returns the largest |strain| over all ranks. An edge
/// between two held vertices cannot be changed here: its residual is 0, its strain is not.
double FastProjection::evaluate(const Freedom& freedom) {
  const DistributedMesh& mesh = cloth_.mesh;
  double max = 0;
  for (Local e = 0; e < mesh.edges.size(); ++e) {
    const auto& [a, b] = mesh.edge_vertices[e];
    const double l = cloth_.rest_length[e];
    const Vec3 d = positions_[b] - positions_[a];
    gradient_[e] = (2.0 / l) * d;
    if (!mesh.owns_edge(e)) continue;
    const double squared = d.squaredNorm();
    residual_[e] = freedom.is_held(a) && freedom.is_held(b) ? 0.0 : squared / l - l - shift_[e] * mu_[e];
    const double strain = std::sqrt(squared) / l - 1.0;
    max = std::max(max, std::isfinite(strain) ? std::abs(strain) : HUGE_VAL);
  }
  return max_over(mesh.comm, max);
}

/// v <- v - W J^T d_mu / h: each owned vertex gathers from its star.
void FastProjection::correct(double dt, const Freedom& freedom, Candidate& candidate) {
  const DistributedMesh& mesh = cloth_.mesh;
  for (Local i = 0; i < mesh.vertices.owned; ++i) {
    Vec3 pull = Vec3::Zero();
    for (const EdgeEnd& end : mesh.star_of(i)) pull += end.sign * change_[end.edge] * gradient_[end.edge];
    candidate.velocities[i] -= inverse_mass_[i] / dt * freedom.allowed(i, pull);
  }
  mesh.vertex_halo.update(candidate.velocities);
  for (std::size_t e = 0; e < mu_.size(); ++e) mu_[e] += change_[e];
}

} // namespace taut
