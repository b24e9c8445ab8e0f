#include "src/constraints/edge_constraints.hpp"

#include "src/state/inverse_mass.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace taut {

EdgeConstraints::EdgeConstraints(const Cloth& cloth, const config::Inextensibility& options,
                                 ConstraintUse use, std::vector<char> constrained)
    : cloth_(cloth), constrained_(std::move(constrained)), compliance_(options.compliance.value_or(0.0)),
      use_(use), gradients_(cloth.mesh.edges.size(), Vec3::Zero()), values_(cloth.mesh.edges.owned),
      scaled_compliance_(cloth.mesh.edges.owned), inverse_mass_(cloth.mesh.vertices.size()) {
  if (use == ConstraintUse::with_contact) lengths_.resize(cloth.mesh.edges.owned);
}

void EdgeConstraints::start(double dt, const Freedom& freedom) {
  dt_ = dt;
  freedom_ = freedom;
  take_inverse_masses(cloth_, freedom, inverse_mass_);
  for (std::size_t e = 0; e < scaled_compliance_.size(); ++e) {
    const auto& [a, b] = cloth_.mesh.edge_vertices[e];
    const double asked = 4.0 * cloth_.rest_length[e] * compliance_ / (dt * dt);
    const double yields = 4.0 * (inverse_mass_[a] + inverse_mass_[b]); // J W J^T of an edge at its length
    scaled_compliance_[e] = bounded_compliance(use_, asked, yields);
  }
}

double EdgeConstraints::evaluate(std::span<const Vec3> x) {
  const DistributedMesh& mesh = cloth_.mesh;
  double max = 0;
  for (Local e = 0; e < mesh.edges.size(); ++e) {
    if (!has(e)) continue; // values and gradients stay 0
    const auto& [a, b] = mesh.edge_vertices[e];
    const double l = cloth_.rest_length[e];
    const Vec3 d = x[b] - x[a];
    gradients_[e] = (2.0 / l) * d;
    if (!mesh.owns_edge(e)) continue;
    const double squared = d.squaredNorm(), length = std::sqrt(squared);
    values_[e] = (use_ == ConstraintUse::alone ? squared : length * length) / l - l;
    if (!lengths_.empty()) lengths_[e] = length;
    const double strain = length / l - 1.0;
    max = std::max(max, std::isfinite(strain) ? std::abs(strain) : HUGE_VAL);
  }
  return max_over(mesh.comm, max);
}

double EdgeConstraints::strain(std::span<const Vec3> x) const {
  double max = 0;
  for (Local e = 0; e < cloth_.mesh.edges.owned; ++e) {
    if (!has(e)) continue;
    const double strain = strain_of(cloth_, x, e);
    max = std::max(max, std::isfinite(strain) ? std::abs(strain) : HUGE_VAL);
  }
  return max_over(cloth_.mesh.comm, max);
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
    mu[e] = has(Local(e)) ? 0.5 * force_density[e] * cloth_.rest_length[e] * dt_ * dt_ : 0.0;
}

void EdgeConstraints::to_force_density(std::span<const double> mu, std::span<double> force_density) const {
  for (std::size_t e = 0; e < mu.size(); ++e)
    force_density[e] = 2.0 * mu[e] / (cloth_.rest_length[e] * dt_ * dt_);
}

} // namespace taut
