#include "src/filters/edge_rows.hpp"

#include "src/filters/solver_options.hpp"

#include <algorithm>

namespace taut {

EdgeSet::EdgeSet(const Cloth& cloth, const config::Inextensibility& options, double weight)
    : constraints_(cloth, options, weight), system_(cloth.mesh, solver_options(options)),
      is_by_cg_(options.solver == config::LinearSolver::cg), change_(cloth.mesh.edges.size()),
      mu_(cloth.mesh.edges.size()) {}

void EdgeSet::start(const State&, double dt, const Freedom& freedom, const Candidate& candidate) {
  constraints_.start(dt, freedom);
  constraints_.to_mu(candidate.multipliers.force_density, mu_);
}

double EdgeSet::evaluate(std::span<const Vec3> x) { return constraints_.evaluate(x); }

SolveReport EdgeSet::solve(double tolerance) {
  system_.assemble(constraints_.gradients(), constraints_.inverse_mass(), constraints_.freedom(),
                   constraints_.scaled_compliance());
  constraints_.residual(mu_, change_);
  if (!threads_ && is_by_cg_ && ThreadStiffness::is_needed(constraints_, mu_))
    threads_.emplace(constraints_.cloth(), system_.yarns());
  if (threads_) threads_->choose(constraints_, mu_);
  SolveReport report =
      uses_threads() ? solve_with_threads(tolerance) : system_.solve(change_, tolerance, change_);
  if (report.failure.empty())
    for (std::size_t e = 0; e < mu_.size(); ++e) mu_[e] += change_[e];
  return report;
}

SolveReport EdgeSet::solve_with_threads(double tolerance) {
  const auto product_with = [this](std::span<const double> mu, std::span<double> product) {
    system_.multiply(mu, product);
    threads_->hold_back(constraints_, mu);
    threads_->subtract(constraints_, product);
  };
  const SolveReport report = system_.solve(product_with, change_, tolerance, change_, threads_->softness());
  threads_->hold_back(constraints_, change_);
  return report;
}

void EdgeSet::finish(Candidate& candidate) const {
  constraints_.to_force_density(mu_, candidate.multipliers.force_density);
}

} // namespace taut
