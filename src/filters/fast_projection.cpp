#include "src/filters/fast_projection.hpp"

#include "src/constraints/projection_options.hpp"
#include "src/state/told_apart.hpp"

#include <fmt/format.h>

#include <cmath>

namespace taut {

/// Of a step, from where half its length is cheaper. The first 0.3 s of two-pins with 561 x 561 vertices took
/// 209 s with this number, 235 with 100, where velocity solves become too many, and 264 without any.
constexpr int many_linear_iterations = 200;

template<ConstraintSet Set>
FastProjection<Set>::FastProjection(const Cloth& cloth, const config::Inextensibility& options)
    : cloth_(cloth), options_(options), set_(cloth, options) {}

template<ConstraintSet Set>
FilterReport FastProjection<Set>::apply(const State& start, double dt, const Freedom& freedom,
                                        Candidate& candidate) {
  FilterReport report;
  set_.start(start, dt, freedom, candidate);
  std::vector<Vec3>& positions = candidate.positions;
  positions.resize(start.positions.size());
  for (;; ++report.iterations) {
    for (std::size_t i = 0; i < positions.size(); ++i)
      positions[i] = start.positions[i] + dt * candidate.velocities[i];
    const double strain = set_.evaluate(positions);
    if (strain <= options_.strain && report.iterations > 0) break;
    if (!std::isfinite(strain) || report.iterations == options_.max_iterations) {
      report.failure = fmt::format("fast projection left a strain of {} after {} iterations (limit {:g})",
                                   told_apart(strain, options_.strain), report.iterations, options_.strain);
      break;
    }
    const SolveReport solved = set_.solve(forcing(strain, options_.strain));
    report.linear_iterations += solved.iterations;
    if (!solved.failure.empty()) {
      report.failure = "the projection's linear solver failed: " + solved.failure;
      break;
    }
    for (Local i = 0; i < cloth_.mesh.vertices.owned; ++i)
      candidate.velocities[i] -= set_.displacement(i) / dt;
    cloth_.mesh.vertex_halo.update(candidate.velocities);
  }
  set_.finish(candidate);
  report.too_costly = report.linear_iterations > many_linear_iterations;
  return report;
}

template class FastProjection<EdgeSet>;
template class FastProjection<MetricSet>;
template class FastProjection<BoundedSet<MetricSet>>;
template class FastProjection<BoundedSet<MixedSet>>;
template class FastProjection<MixedSet>;

} // namespace taut
