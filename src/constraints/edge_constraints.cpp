#include "src/constraints/edge_constraints.hpp"

#include "src/state/inverse_mass.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace taut {

namespace {

constexpr double least_missing =
    0.5; ///< of a length, that counts; with 0.2 piles take half as many iterations again

Vec3 edge_vector(const Cloth& cloth, std::span<const Vec3> x, Local edge) {
  const auto& [a, b] = cloth.mesh.edge_vertices[edge];
  return x[b] - x[a];
}

} // namespace

EdgeConstraints::EdgeConstraints(const Cloth& cloth, const config::Inextensibility& options,
                                 const ComplianceBounds& bounds, std::vector<char> constrained)
    : cloth_(cloth), constrained_(std::move(constrained)), compliance_(options.compliance.value_or(0.0)),
      bounds_(bounds), gradients_(cloth.mesh.edges.size(), Vec3::Zero()), values_(cloth.mesh.edges.owned),
      lengths_(values_), scaled_compliance_(cloth.mesh.edges.owned),
      inverse_mass_(cloth.mesh.vertices.size()) {}

void EdgeConstraints::start(double dt, const Freedom& freedom) {
  dt_ = dt;
  freedom_ = freedom;
  take_inverse_masses(cloth_, freedom, inverse_mass_);
  for (std::size_t e = 0; e < scaled_compliance_.size(); ++e) {
    const auto& [a, b] = cloth_.mesh.edge_vertices[e];
    const double asked = 4.0 * cloth_.rest_length[e] * compliance_ / (dt * dt);
    const double yields = 4.0 * (inverse_mass_[a] + inverse_mass_[b]); // J W J^T of an edge at its length
    scaled_compliance_[e] = std::min(asked, bounds_.part * yields);
  }
}

double EdgeConstraints::evaluate(std::span<const Vec3> x) {
  return linearize_all(x, [](Local, const Vec3& d) { return d; });
}

double EdgeConstraints::evaluate(std::span<const Vec3> x, std::span<const Vec3> start) {
  return linearize_all(x, [&](Local e, const Vec3& d) {
    const Vec3 was = edge_vector(cloth_, start, e);
    const double l = cloth_.rest_length[e];
    const double missing = 1 - d.norm() / l - least_missing, back = -d.dot(was) / (l * l);
    return Vec3(d + (std::max(0.0, missing) + std::max(0.0, back)) * was);
  });
}

/// Every edge that is d at the edge vector `at(edge, d)`; without a constraint, values and gradients stay 0.
template<class At>
double EdgeConstraints::linearize_all(std::span<const Vec3> x, const At& at) {
  double max = 0;
  for (Local e = 0; e < cloth_.mesh.edges.size(); ++e) {
    if (!has(e)) continue;
    const Vec3 d = edge_vector(cloth_, x, e);
    max = std::max(max, linearize(e, d, at(e, d)));
  }
  return max_over(cloth_.mesh.comm, max);
}

/// At the edge vector `at`, for one that is `d`; returns the |strain| of an owned edge.
double EdgeConstraints::linearize(Local e, const Vec3& d, const Vec3& at) {
  const double l = cloth_.rest_length[e];
  gradients_[e] = (2.0 / l) * at;
  if (!cloth_.mesh.owns_edge(e)) return 0;
  values_[e] = at.dot(2.0 * d - at) / l - l;
  lengths_[e] = at.normalized().dot(d);
  const double strain = d.norm() / l - 1.0;
  return std::isfinite(strain) ? std::abs(strain) : HUGE_VAL;
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
    c[e] = can_change(Local(e)) ? values_[e] - yield_to(mu[e], Local(e)).length : 0.0;
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
