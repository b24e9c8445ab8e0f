#include "src/filters/edge_rows.hpp"

#include "src/filters/solver_options.hpp"

#include <algorithm>

namespace taut {

EdgeRows::EdgeRows(const Cloth& cloth, const config::Inextensibility& options, double weight)
    : constraints_(cloth, options, weight), system_(cloth.mesh, solver_options(options)),
      softness_(cloth.mesh.edges.owned), product_of_(cloth.mesh.edges.size()),
      change_(cloth.mesh.edges.size()), mu_(cloth.mesh.edges.size()) {
  if (options.solver == config::LinearSolver::cg) threads_.emplace(cloth);
}

void EdgeRows::start(const State&, double dt, const Freedom& freedom, const Candidate& candidate) {
  constraints_.start(dt, freedom);
  constraints_.to_mu(candidate.force_density, mu_);
}

double EdgeRows::evaluate(std::span<const Vec3> x) { return constraints_.evaluate(x); }

SolveReport EdgeRows::solve(double tolerance) {
  system_.assemble(constraints_.gradients(), constraints_.inverse_mass(), constraints_.freedom(),
                   constraints_.shift());
  constraints_.residual(mu_, change_);
  if (threads_) threads_->choose(constraints_, mu_);
  SolveReport report =
      uses_threads() ? solve_with_threads(tolerance) : system_.solve(change_, tolerance, change_);
  if (report.failure.empty())
    for (std::size_t e = 0; e < mu_.size(); ++e) mu_[e] += change_[e];
  return report;
}

/// Along a straight thread the matrix is (4 |d|^2/l^2) (D + (B W B^T)^-1)^-1, so to the inverse of that
/// without D comes D/|g|^2.
SolveReport EdgeRows::solve_with_threads(double tolerance) {
  const auto stiffness = threads_->stiffness();
  for (std::size_t e = 0; e < softness_.size(); ++e)
    softness_[e] = stiffness[e] > 0 ? stiffness[e] / constraints_.gradients()[e].squaredNorm() : 0.0;
  const auto product_with = [this](std::span<const double> mu, std::span<double> product) {
    system_.multiply(mu, product);
    std::copy(mu.begin(), mu.end(), product_of_.begin());
    constraints_.cloth().mesh.edge_halo.update(product_of_);
    threads_->hold_back(constraints_, product_of_);
    threads_->subtract(constraints_, product);
  };
  const SolveReport report = system_.solve(product_with, change_, tolerance, change_, softness_);
  threads_->hold_back(constraints_, change_);
  return report;
}

void EdgeRows::finish(Candidate& candidate) const {
  constraints_.to_force_density(mu_, candidate.force_density);
}

} // namespace taut
