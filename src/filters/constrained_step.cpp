#include "src/filters/constrained_step.hpp"

#include "src/state/told_apart.hpp"

#include <fmt/format.h>

#include <cmath>

namespace taut {

ConstrainedStep::ConstrainedStep(const Cloth& cloth, const config::Inextensibility& options)
    : constraints(cloth, options), free(cloth.mesh.vertices.size()), x(cloth.mesh.vertices.size()),
      mu(cloth.mesh.edges.size()), options_(options) {}

void ConstrainedStep::begin(const State& start, double dt, const Freedom& freedom,
                            const Candidate& candidate) {
  start_ = &start;
  dt_ = dt;
  constraints.start(dt, freedom);
  constraints.to_mu(candidate.multipliers.force_density, mu);
  for (std::size_t i = 0; i < x.size(); ++i) x[i] = start.positions[i] + dt * candidate.velocities[i];
  constraints.evaluate(x);
  for (Local i = 0; i < mesh().vertices.owned; ++i)
    free[i] = x[i] + constraints.inverse_mass()[i] * constraints.pull(i, constraints.gradients(), mu);
  mesh().vertex_halo.update(free);
}

FilterReport ConstrainedStep::solve(std::string_view method,
                                    const std::function<SolveReport(double strain)>& iterate,
                                    const std::function<bool()>& is_settled) {
  FilterReport report;
  for (;; ++report.iterations) {
    const double strain = constraints.evaluate(x);
    if (report.iterations > 0 && strain <= options_.strain && is_settled()) return report;
    if (!std::isfinite(strain) || report.iterations == options_.max_iterations) {
      report.failure = fmt::format("{} left a strain of {} after {} iterations (limit {:g})", method,
                                   told_apart(strain, options_.strain), report.iterations, options_.strain);
      return report;
    }
    const SolveReport solved = iterate(strain);
    report.linear_iterations += solved.iterations;
    if (solved.failure.empty()) continue;
    report.failure = fmt::format("the linear solver of {} failed: {}", method, solved.failure);
    return report;
  }
}

void ConstrainedStep::end(Candidate& candidate) const {
  for (std::size_t i = 0; i < x.size(); ++i)
    if (is_free(Local(i))) candidate.velocities[i] = (x[i] - start_->positions[i]) / dt_;
  constraints.to_force_density(mu, candidate.multipliers.force_density);
}

void ConstrainedStep::pull(std::span<const Vec3> gradients, std::span<const double> d_mu) {
  for (Local i = 0; i < mesh().vertices.owned; ++i)
    x[i] -= constraints.inverse_mass()[i] * constraints.pull(i, gradients, d_mu);
  mesh().vertex_halo.update(x);
}

} // namespace taut
