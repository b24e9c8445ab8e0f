#include "src/filters/fast_projection.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace taut {

namespace {

SolverOptions solver_options(const config::Inextensibility& options) {
  return {options.solver == config::LinearSolver::mumps ? SolverOptions::Kind::mumps : SolverOptions::Kind::cg, 1000};
}

/// How tightly an iteration is solved: no tighter than what is left to do asks for (inexact Newton).
double forcing(double strain, double limit) { return std::clamp(0.1 * limit / strain, 1e-4, 1e-2); }

} // namespace

FastProjection::FastProjection(const Cloth& cloth, const config::Inextensibility& options)
    : cloth_(cloth), options_(options), system_(cloth.mesh, solver_options(options), options.compliance),
      positions_(cloth.mesh.vertices.size()), gradient_(cloth.mesh.edges.size()),
      inverse_mass_(cloth.mesh.vertices.size()), constraint_(cloth.mesh.edges.owned), mu_(cloth.mesh.edges.size()),
      total_(cloth.mesh.edges.size()) {}

FilterReport FastProjection::apply(const State& start, double dt, std::span<const char> prescribed,
                                   Candidate& candidate) {
  FilterReport report;
  for (std::size_t i = 0; i < inverse_mass_.size(); ++i)
    inverse_mass_[i] = prescribed[i] ? 0.0 : 1.0 / cloth_.mass[i];
  std::fill(total_.begin(), total_.end(), 0.0);
  for (;; ++report.iterations) {
    for (std::size_t i = 0; i < positions_.size(); ++i)
      positions_[i] = start.positions[i] + dt * candidate.velocities[i];
    const double strain = evaluate(prescribed);
    if (strain <= options_.strain) break;
    if (!std::isfinite(strain) || report.iterations == options_.max_iterations) {
      report.failure = fmt::format("fast projection left a strain of {:.3g} after {} iterations (limit {:g})", strain,
                                   report.iterations, options_.strain);
      break;
    }
    system_.assemble(gradient_, inverse_mass_);
    const SolveReport solved = system_.solve(constraint_, forcing(strain, options_.strain), mu_);
    report.linear_iterations += solved.iterations;
    if (!solved.failure.empty()) {
      report.failure = "the projection's linear solver failed: " + solved.failure;
      break;
    }
    correct(dt, candidate);
  }
  for (std::size_t e = 0; e < total_.size(); ++e)
    candidate.force_density[e] += 2.0 * total_[e] / (cloth_.rest_length[e] * dt * dt);
  return report;
}

/// Constraints and gradients at `positions_`; returns the largest |strain| over all ranks. An edge between two prescribed
/// vertices cannot be changed here: its constraint is left out, its strain is not.
double FastProjection::evaluate(std::span<const char> prescribed) {
  const DistributedMesh& mesh = cloth_.mesh;
  double max = 0;
  for (Local e = 0; e < mesh.edges.size(); ++e) {
    const auto& [a, b] = mesh.edge_vertices[e];
    const double l = cloth_.rest_length[e];
    const Vec3 d = positions_[b] - positions_[a];
    gradient_[e] = (2.0 / l) * d;
    if (e >= mesh.edges.owned) continue;
    const double squared = d.squaredNorm();
    constraint_[e] = prescribed[a] && prescribed[b] ? 0.0 : squared / l - l;
    const double strain = std::sqrt(squared) / l - 1.0;
    max = std::max(max, std::isfinite(strain) ? std::abs(strain) : HUGE_VAL);
  }
  return max_over(mesh.comm, max);
}

/// v <- v - W J^T mu / h: each owned vertex gathers from its star.
void FastProjection::correct(double dt, Candidate& candidate) {
  const DistributedMesh& mesh = cloth_.mesh;
  for (Local i = 0; i < mesh.vertices.owned; ++i) {
    Vec3 pull = Vec3::Zero();
    for (const EdgeEnd& end : mesh.star_of(i)) pull += end.sign * mu_[end.edge] * gradient_[end.edge];
    candidate.velocities[i] -= inverse_mass_[i] / dt * pull;
  }
  mesh.vertex_halo.update(candidate.velocities);
  for (std::size_t e = 0; e < total_.size(); ++e) total_[e] += mu_[e];
}

} // namespace taut
