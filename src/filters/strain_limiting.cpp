#include "src/filters/strain_limiting.hpp"
#include "src/constraints/strain_gauge.hpp"
#include "src/state/told_apart.hpp"

#include <fmt/format.h>

#include <cmath>

namespace taut {

StrainLimiting::StrainLimiting(const Cloth& cloth, const config::Inextensibility& options)
    : cloth_(cloth), options_(options), sweeps_(cloth), x_(cloth.mesh.vertices.size()),
      s_(cloth.mesh.edges.size()) {}

FilterReport StrainLimiting::apply(const State& start, double dt, const Freedom& freedom,
                                   Candidate& candidate) {
  const auto length = [&](Local e) {
    const auto& [a, b] = cloth_.mesh.edge_vertices[e];
    return (x_[b] - x_[a]).norm();
  };
  sweeps_.start(dt, 0.0, freedom);
  for (std::size_t i = 0; i < x_.size(); ++i) x_[i] = start.positions[i] + dt * candidate.velocities[i];
  for (std::size_t e = 0; e < s_.size(); ++e)
    s_[e] = candidate.multipliers.force_density[e] * length(Local(e)) * dt * dt;
  const FilterReport report = sweep_to_limit();
  for (std::size_t i = 0; i < x_.size(); ++i)
    if (!freedom.is_held(Local(i))) candidate.velocities[i] = (x_[i] - start.positions[i]) / dt;
  for (Local e = 0; e < cloth_.mesh.edges.owned; ++e)
    candidate.multipliers.force_density[e] = s_[e] / (length(e) * dt * dt);
  cloth_.mesh.edge_halo.update(candidate.multipliers.force_density);
  return report;
}

FilterReport StrainLimiting::sweep_to_limit() {
  const config::Limiting limiting = options_.limiting.value_or(config::Limiting{});
  FilterReport report;
  for (;; ++report.iterations) {
    const double strain = measure_strain(cloth_, x_).max;
    if (report.iterations > 0 && strain <= options_.strain) return report;
    if (report.iterations == limiting.max_sweeps && !limiting.must_reach_limit) return report;
    if (!std::isfinite(strain) || report.iterations == limiting.max_sweeps) {
      report.failure = fmt::format("strain limiting left a strain of {} after {} sweeps (limit {:g})",
                                   told_apart(strain, options_.strain), report.iterations, options_.strain);
      return report;
    }
    if (options_.method == config::InextensibilityMethod::jacobi)
      sweeps_.jacobi(x_, s_);
    else
      sweeps_.gauss_seidel(x_, s_);
  }
}

} // namespace taut
