#include "src/linear/kkt_schur.hpp"

#include <algorithm>

namespace taut {

std::vector<std::int32_t> edge_slots(const DistributedMesh& mesh, const Pattern& pattern) {
  std::vector<std::int32_t> slots;
  for (Local i = 0; i < mesh.vertices.owned; ++i)
    for (const EdgeEnd& end : mesh.star_of(i)) slots.push_back(std::int32_t(pattern.slot(i, end.other)));
  return slots;
}

void fill_stiffened_mass(const DistributedMesh& mesh, std::span<const std::int32_t> slots,
                         std::span<const double> mass, std::span<const double> weight, VertexMatrix& matrix) {
  matrix.clear();
  auto slot = slots.begin();
  for (Local i = 0; i < mesh.vertices.owned; ++i) {
    double diagonal = mass[i];
    for (const EdgeEnd& end : mesh.star_of(i)) {
      diagonal += weight[end.edge];
      matrix.add_entry(*slot++, -weight[end.edge]);
    }
    matrix.add_diagonal(i, diagonal);
  }
}

KktSystem::Schur::Schur(const DistributedMesh& mesh, const Pattern& pattern, const SolverOptions& options)
    : mesh_(mesh), slots_(edge_slots(mesh, pattern)), stiffened_mass_(pattern),
      vertices_(mesh, pattern, options, "stiffness"), edges_(mesh, options), b_(mesh.vertices.size()),
      x_(mesh.vertices.size()), mu_(mesh.edges.size()), rhs_(mesh.edges.owned),
      inverse_(mesh.vertices.size()) {}

void KktSystem::Schur::assemble(const Terms& terms) {
  terms_ = terms;
  fill_stiffened_mass(mesh_, slots_, terms.mass, terms.weight, stiffened_mass_);
  const Pattern& pattern = stiffened_mass_.pattern();
  for (Local i = 0; i < mesh_.vertices.owned; ++i)
    inverse_[i] = terms.freedom->is_held(i) ? 0.0 : 1.0 / stiffened_mass_.values()[pattern.diagonal(i)];
  mesh_.vertex_halo.update(inverse_);
  edges_.assemble(terms.gradient, inverse_, *terms.freedom, terms.scaled_compliance);
}

void KktSystem::Schur::solve_vertices(std::span<const Vec3> b, double tolerance, std::vector<Vec3>& x) {
  std::fill(x.begin(), x.end(), Vec3::Zero());
  const SolveReport solved = vertices_.solve(stiffened_mass_, b, *terms_.freedom, tolerance, x);
  if (!solved.failure.empty()) failure_ = solved.failure;
}

void KktSystem::Schur::gather(std::span<const double> mu, std::span<Vec3> pull) const {
  for (Local i = 0; i < mesh_.vertices.owned; ++i) {
    pull[i] = Vec3::Zero();
    for (const EdgeEnd& end : mesh_.star_of(i))
      pull[i] += end.sign * mu[end.edge] * terms_.gradient[end.edge];
  }
}

void KktSystem::Schur::differences(std::span<const Vec3> x, std::span<double> result) const {
  for (Local e = 0; e < mesh_.edges.owned; ++e) {
    const auto& [a, b] = mesh_.edge_vertices[e];
    result[e] = terms_.gradient[e].dot(x[b] - x[a]);
  }
}

/// product = (J A^-1 J^T + a) mu. Rows of edges that cannot be changed are those of the unit matrix, as in
/// the preconditioner.
void KktSystem::Schur::apply(std::span<const double> mu, std::span<double> product, double tolerance) {
  std::copy(mu.begin(), mu.end(), mu_.begin());
  mesh_.edge_halo.update(mu_);
  gather(mu_, b_);
  solve_vertices(b_, tolerance, x_);
  differences(x_, product);
  for (Local e = 0; e < mesh_.edges.owned; ++e) {
    const auto& [a, b] = mesh_.edge_vertices[e];
    if (terms_.freedom->is_held(a) && terms_.freedom->is_held(b))
      product[e] = mu[e];
    else
      product[e] += terms_.scaled_compliance[e] * mu[e];
  }
}

SolveReport KktSystem::Schur::solve(std::span<const Vec3> f, std::span<const double> c, double tolerance,
                                    std::vector<Vec3>& dx, std::vector<double>& dmu) {
  const double inner = 0.01 * tolerance; // CG wants the same operator in every iteration
  failure_.clear();
  solve_vertices(f, inner, dx);
  differences(dx, rhs_);
  for (std::size_t e = 0; e < rhs_.size(); ++e) rhs_[e] += c[e];
  SolveReport report =
      edges_.solve([&](std::span<const double> mu, std::span<double> product) { apply(mu, product, inner); },
                   rhs_, tolerance, dmu);
  gather(dmu, b_);
  for (Local i = 0; i < mesh_.vertices.owned; ++i) b_[i] = f[i] - b_[i];
  solve_vertices(b_, inner, dx);
  if (report.failure.empty()) report.failure = failure_;
  return report;
}

} // namespace taut
