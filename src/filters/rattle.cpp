#include "src/filters/rattle.hpp"

#include "src/constraints/projection_options.hpp"

namespace taut {

Rattle::Rattle(const Cloth& cloth, const config::Inextensibility& options)
    : shake_(cloth, options), system_(cloth.mesh, solver_options(options)), rates_(cloth.mesh.edges.owned),
      eta_(cloth.mesh.edges.size()) {}

FilterReport Rattle::apply(const State& start, double dt, const Freedom& freedom, Candidate& candidate) {
  FilterReport report = shake_.apply("rattle", start, dt, freedom, candidate);
  if (!report.failure.empty()) return report;
  const SolveReport solved = project_velocities(candidate);
  report.linear_iterations += solved.iterations;
  if (!solved.failure.empty())
    report.failure = "the linear solver of rattle's velocities failed: " + solved.failure;
  return report;
}

SolveReport Rattle::project_velocities(Candidate& candidate) {
  constexpr double tolerance = 1e-6;
  const EdgeConstraints& c = shake_.step().constraints; // evaluated at the end positions
  const DistributedMesh& mesh = c.cloth().mesh;
  for (Local e = 0; e < mesh.edges.owned; ++e) {
    const auto& [a, b] = mesh.edge_vertices[e];
    const bool can_change = shake_.step().is_free(a) || shake_.step().is_free(b);
    rates_[e] = can_change ? c.gradients()[e].dot(candidate.velocities[b] - candidate.velocities[a]) : 0.0;
  }
  system_.assemble(c.gradients(), c.inverse_mass(), c.freedom(), c.scaled_compliance());
  const SolveReport solved = system_.solve(rates_, tolerance, eta_);
  candidate.end_velocities = candidate.velocities;
  for (Local i = 0; i < mesh.vertices.owned; ++i)
    candidate.end_velocities[i] -= c.inverse_mass()[i] * c.pull(i, c.gradients(), eta_);
  mesh.vertex_halo.update(candidate.end_velocities);
  return solved;
}

} // namespace taut
