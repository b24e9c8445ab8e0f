#include "src/filters/edge_rows.hpp"

#include "src/filters/solver_options.hpp"

namespace taut {

EdgeRows::EdgeRows(const Cloth& cloth, const config::Inextensibility& options, double weight)
    : constraints_(cloth, options, weight), system_(cloth.mesh, solver_options(options)),
      change_(cloth.mesh.edges.size()), mu_(cloth.mesh.edges.size()) {}

void EdgeRows::start(const State&, double dt, const Freedom& freedom, const Candidate& candidate) {
  constraints_.start(dt, freedom);
  constraints_.to_mu(candidate.force_density, mu_);
}

double EdgeRows::evaluate(std::span<const Vec3> x) { return constraints_.evaluate(x); }

SolveReport EdgeRows::solve(double tolerance) {
  system_.assemble(constraints_.gradients(), constraints_.inverse_mass(), constraints_.freedom(),
                   constraints_.shift());
  constraints_.residual(mu_, change_);
  SolveReport report = system_.solve(change_, tolerance, change_);
  if (report.failure.empty())
    for (std::size_t e = 0; e < mu_.size(); ++e) mu_[e] += change_[e];
  return report;
}

void EdgeRows::finish(Candidate& candidate) const {
  constraints_.to_force_density(mu_, candidate.force_density);
}

} // namespace taut
