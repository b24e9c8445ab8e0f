#include "src/filters/contact_qp.hpp"

#include <cmath>

namespace taut {

namespace {

/// Part of a row's diagonal that is added to it. Rows of many layers depend on one another; the outer
/// iterations take away what the compliance leaves.
constexpr double normal_compliance = 0.05, friction_compliance = 2e-3;

} // namespace

ContactQp::ContactQp(const Cloth& cloth, const ContactSearch& search)
    : cloth_(cloth), search_(search), yarns_(cloth.mesh), edges_(cloth.mesh.edges.owned),
      edge_values_(cloth.mesh.edges.size()), push_(cloth.mesh.vertices.size()) {}

QpReport ContactQp::solve(const EdgeEquations& edges, std::span<const ContactRow> rows, int most_products) {
  edge_equations_ = &edges;
  rows_ = rows;
  z_.assign(edges.guess.begin(), edges.guess.begin() + edges_);
  rhs_.assign(edges.residual.begin(), edges.residual.begin() + edges_);
  tolerance_.assign(edges.tolerance.begin(), edges.tolerance.begin() + edges_);
  lower_.clear();
  upper_.clear();
  for (const ContactRow& row : rows) {
    rhs_.push_back(row.missing);
    lower_.push_back(row.lower);
    upper_.push_back(row.upper);
    tolerance_.push_back(row.slack);
    z_.push_back(row.guess);
  }
  set_diagonal();
  yarns_.factor(edges.gradient, edges.inverse_mass, edges.freedom, edges.shift);
  const BoundedQp qp{[this](auto z, auto result) { multiply(z, result); },
                     [this](auto r, auto s) { precondition(r, s); },
                     rhs_,
                     edges_,
                     lower_,
                     upper_,
                     tolerance_};
  const QpReport report = taut::solve(cloth_.mesh.comm, qp, most_products, z_);
  spread(z_);
  return report;
}

void ContactQp::set_diagonal() {
  row_diagonal_.clear();
  row_compliance_.clear();
  for (const ContactRow& row : rows_) {
    row_compliance_.push_back((row.is_normal ? normal_compliance : friction_compliance) * row.mobility);
    row_diagonal_.push_back(row.mobility + row_compliance_.back());
  }
}

/// push_ = W R' z.
void ContactQp::spread(std::span<const double> z) {
  const DistributedMesh& mesh = cloth_.mesh;
  std::copy(z.begin(), z.begin() + edges_, edge_values_.begin());
  mesh.edge_halo.begin_update(edge_values_);
  field_.assign(search_.size(), Vec3::Zero());
  for (std::size_t k = 0; k < rows_.size(); ++k) {
    const ContactRow& row = rows_[k];
    for (int i = 0; i < 4; ++i) field_[row.vertices[i]] += z[edges_ + k] * row.weights[i] * row.direction;
  }
  mesh.edge_halo.end_update(edge_values_);
  search_.accumulate(field_);
  for (Local i = 0; i < mesh.vertices.owned; ++i) {
    const Vec3 pull = pull_at(mesh, *edge_equations_, edge_values_, i);
    push_[i] = edge_equations_->inverse_mass[i] * edge_equations_->freedom.allowed(i, field_[i] - pull);
  }
  mesh.vertex_halo.update(push_);
}

void ContactQp::multiply(std::span<const double> z, std::span<double> result) {
  const DistributedMesh& mesh = cloth_.mesh;
  spread(z);
  field_.assign(search_.size(), Vec3::Zero());
  std::copy(push_.begin(), push_.begin() + search_.own(), field_.begin());
  search_.update(field_);
  for (std::size_t e = 0; e < edges_; ++e) {
    const auto& [a, b] = mesh.edge_vertices[e];
    const bool is_fixed = edge_equations_->inverse_mass[a] + edge_equations_->inverse_mass[b] == 0;
    result[e] =
        is_fixed ? z[e]
                 : edge_equations_->shift[e] * z[e] - edge_equations_->gradient[e].dot(push_[b] - push_[a]);
  }
  for (std::size_t k = 0; k < rows_.size(); ++k) {
    const ContactRow& row = rows_[k];
    Vec3 sum = Vec3::Zero();
    for (int i = 0; i < 4; ++i) sum += row.weights[i] * field_[row.vertices[i]];
    result[edges_ + k] = row.direction.dot(sum) + row_compliance_[k] * z[edges_ + k];
  }
}

void ContactQp::precondition(std::span<const double> r, std::span<double> s) const {
  yarns_.solve(r.first(edges_), s.first(edges_));
  for (std::size_t k = 0; k < rows_.size(); ++k) s[edges_ + k] = r[edges_ + k] / row_diagonal_[k];
}

} // namespace taut
