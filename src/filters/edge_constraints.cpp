#include "src/filters/edge_constraints.hpp"

#include <algorithm>
#include <cmath>

namespace taut {

double compliance_of(const config::Inextensibility& options, double weight) {
  return options.compliance.value_or(weight > 0 ? 4.9 * std::pow(0.1 * options.strain, 1.5) / weight : 0.0);
}

EdgeConstraints::EdgeConstraints(const Cloth& cloth, const config::Inextensibility& options, double weight)
    : cloth_(cloth), compliance_(compliance_of(options, weight)), gradients_(cloth.mesh.edges.size()),
      values_(cloth.mesh.edges.owned), scaled_compliance_(cloth.mesh.edges.owned),
      inverse_mass_(cloth.mesh.vertices.size()) {}

void EdgeConstraints::start(double dt, const Freedom& freedom) {
  dt_ = dt;
  freedom_ = freedom;
  for (std::size_t i = 0; i < inverse_mass_.size(); ++i)
    inverse_mass_[i] = freedom.is_held(Local(i)) ? 0.0 : 1.0 / cloth_.mass[i];
  for (std::size_t e = 0; e < scaled_compliance_.size(); ++e)
    scaled_compliance_[e] = 4.0 * cloth_.rest_length[e] * compliance_ / (dt * dt);
}

double EdgeConstraints::evaluate(std::span<const Vec3> x) {
  const DistributedMesh& mesh = cloth_.mesh;
  double max = 0;
  for (Local e = 0; e < mesh.edges.size(); ++e) {
    const auto& [a, b] = mesh.edge_vertices[e];
    const double l = cloth_.rest_length[e];
    const Vec3 d = x[b] - x[a];
    gradients_[e] = (2.0 / l) * d;
    if (!mesh.owns_edge(e)) continue;
    const double squared = d.squaredNorm();
    values_[e] = squared / l - l;
    const double strain = std::sqrt(squared) / l - 1.0;
    max = std::max(max, std::isfinite(strain) ? std::abs(strain) : HUGE_VAL);
  }
  return max_over(mesh.comm, max);
}

void EdgeConstraints::residual(std::span<const double> mu, std::span<double> c) const {
  for (std::size_t e = 0; e < values_.size(); ++e)
    c[e] = can_change(Local(e)) ? values_[e] - scaled_compliance_[e] * mu[e] : 0.0;
}

bool EdgeConstraints::can_change(Local edge) const {
  const auto& [a, b] = cloth_.mesh.edge_vertices[edge];
  const Vec3& g = gradients_[edge];
  return !freedom_.allowed(a, g).isZero(0) || !freedom_.allowed(b, g).isZero(0);
}

void EdgeConstraints::to_mu(std::span<const double> force_density, std::span<double> mu) const {
  for (std::size_t e = 0; e < mu.size(); ++e)
    mu[e] = 0.5 * force_density[e] * cloth_.rest_length[e] * dt_ * dt_;
}

void EdgeConstraints::to_force_density(std::span<const double> mu, std::span<double> force_density) const {
  for (std::size_t e = 0; e < mu.size(); ++e)
    force_density[e] = 2.0 * mu[e] / (cloth_.rest_length[e] * dt_ * dt_);
}

} // namespace taut
