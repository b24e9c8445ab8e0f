#include "src/filters/contact_qp.hpp"

#include <utility>

namespace taut {

namespace {

/// Part of a row's diagonal that is added to it. Rows of many layers depend on one another; the outer
/// iterations take away what the compliance leaves.
constexpr double normal_compliance = 0.05, friction_compliance = 2e-3;

} // namespace

ContactQp::ContactQp(const Cloth& cloth, const ContactSearch& search)
    : cloth_(cloth), search_(search), yarns_(cloth.mesh), edges_(cloth.mesh.edges.owned),
      scaled_compliance_(edges_), edge_values_(cloth.mesh.edges.size()), push_(cloth.mesh.vertices.size()) {}

QpReport ContactQp::solve(const EdgeEquations& edges, std::span<const Contact> contacts,
                          std::span<const ContactRow> rows, const QpEffort& effort) {
  edge_equations_ = &edges;
  z_.assign(edges.guess.begin(), edges.guess.begin() + edges_);
  rhs_.assign(edges.residual.begin(), edges.residual.begin() + edges_);
  tolerance_.assign(edges.tolerance.begin(), edges.tolerance.begin() + edges_);
  for (std::size_t e = 0; e < edges_; ++e) {
    const auto& [a, b] = cloth_.mesh.edge_vertices[e];
    scaled_compliance_[e] =
        edges.inverse_mass[a] + edges.inverse_mass[b] == 0 ? 1.0 : edges.scaled_compliance[e];
  }
  take_rows(contacts, rows);
  yarns_.factor(edges.gradient, edges.inverse_mass, edges.freedom, edges.scaled_compliance);
  const BoundedQp qp{[this](auto z, auto result) { multiply(z, result); },
                     [this](auto r, auto s) { precondition(r, s); },
                     rhs_,
                     edges_,
                     lower_,
                     upper_,
                     tolerance_};
  const QpReport report = taut::solve(cloth_.mesh.comm, qp, effort, z_);
  spread(z_);
  return report;
}

void ContactQp::add_block(const Contact& contact) {
  Block block{0, 0};
  for (int i = 0; i < 4; ++i) {
    const Local v = contact.vertices[i];
    const bool is_cloth = v < search_.own() || v >= search_.home();
    if (!is_cloth || contact.weights[i] == 0) continue;
    parts_.push_back({v, contact.weights[i]});
    ++block.parts;
  }
  blocks_.push_back(block);
}

void ContactQp::take_rows(std::span<const Contact> contacts, std::span<const ContactRow> rows) {
  lower_.clear();
  upper_.clear();
  blocks_.clear();
  parts_.clear();
  directions_.clear();
  row_diagonal_.clear();
  row_compliance_.clear();
  Local last = -1;
  for (const ContactRow& row : rows) {
    const Contact& contact = contacts[row.contact];
    if (std::exchange(last, row.contact) != row.contact) add_block(contact);
    ++blocks_.back().rows;
    directions_.push_back(row.direction);
    rhs_.push_back(row.violation);
    lower_.push_back(row.lower);
    upper_.push_back(row.upper);
    tolerance_.push_back(row.slack);
    z_.push_back(row.guess);
    row_compliance_.push_back((row.is_normal ? normal_compliance : friction_compliance) *
                              contact.inverse_effective_mass);
    row_diagonal_.push_back(contact.inverse_effective_mass + row_compliance_.back());
  }
}

/// push_ = W R' z.
void ContactQp::spread(std::span<const double> z) {
  const DistributedMesh& mesh = cloth_.mesh;
  std::copy(z.begin(), z.begin() + edges_, edge_values_.begin());
  mesh.edge_halo.begin_update(edge_values_);
  field_.assign(search_.size(), Vec3::Zero());
  std::size_t k = 0; // row
  const Part* part = parts_.data();
  for (const Block& block : blocks_) {
    Vec3 force = Vec3::Zero();
    for (const std::size_t end = k + block.rows; k < end; ++k) force += z[edges_ + k] * directions_[k];
    for (const Part* end = part + block.parts; part < end; ++part)
      field_[part->vertex] += part->weight * force;
  }
  mesh.edge_halo.end_update(edge_values_);
  const Local own = mesh.vertices.owned; // these come first in contact fields too
  for (std::size_t e = 0; e < edge_values_.size(); ++e) {
    const auto& [a, b] = mesh.edge_vertices[e];
    const Vec3 pull = edge_values_[e] * edge_equations_->gradient[e];
    if (a < own) field_[a] += pull;
    if (b < own) field_[b] -= pull;
  }
  search_.accumulate(field_);
  for (Local i = 0; i < own; ++i)
    push_[i] = edge_equations_->inverse_mass[i] * edge_equations_->freedom.allowed(i, field_[i]);
  mesh.vertex_halo.update(push_);
}

void ContactQp::multiply(std::span<const double> z, std::span<double> result) {
  const DistributedMesh& mesh = cloth_.mesh;
  spread(z);
  std::copy(push_.begin(), push_.begin() + search_.own(), field_.begin());
  search_.update(field_);
  for (std::size_t e = 0; e < edges_; ++e) {
    const auto& [a, b] = mesh.edge_vertices[e];
    result[e] = scaled_compliance_[e] * z[e] - edge_equations_->gradient[e].dot(push_[b] - push_[a]);
  }
  std::size_t k = 0; // row
  const Part* part = parts_.data();
  for (const Block& block : blocks_) {
    Vec3 parting = Vec3::Zero();
    for (const Part* end = part + block.parts; part < end; ++part)
      parting += part->weight * field_[part->vertex];
    for (const std::size_t end = k + block.rows; k < end; ++k)
      result[edges_ + k] = directions_[k].dot(parting) + row_compliance_[k] * z[edges_ + k];
  }
}

void ContactQp::precondition(std::span<const double> r, std::span<double> s) const {
  yarns_.solve(r.first(edges_), s.first(edges_));
  for (std::size_t k = 0; k < row_diagonal_.size(); ++k) s[edges_ + k] = r[edges_ + k] / row_diagonal_[k];
}

} // namespace taut
