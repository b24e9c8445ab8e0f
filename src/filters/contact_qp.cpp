#include "src/filters/contact_qp.hpp"

#include "src/constraints/bounded_set.hpp"

#include <utility>

namespace taut {

namespace {

/// Part of a row's diagonal that is added to it. Rows of many layers depend on one another; the outer
/// iterations take away what the compliance leaves.
constexpr double normal_compliance = 0.05, friction_compliance = 2e-3;

} // namespace

template<ConstraintSet Set>
ContactQp<Set>::ContactQp(const Cloth& cloth, const ContactSearch& search)
    : cloth_(cloth), search_(search), push_(cloth.mesh.vertices.size()) {}

template<ConstraintSet Set>
QpReport ContactQp<Set>::solve(Set& set, std::span<const Contact> contacts, std::span<const ContactRow> rows,
                               const QpEffort& effort, QpGuess guess) {
  set_ = &set;
  set.factor(set.inverse_mass());
  take_set(guess);
  take_rows(contacts, rows);
  return solve(effort);
}

template<ConstraintSet Set>
QpReport ContactQp<Set>::solve(const QpEffort& effort) {
  const BoundedQp qp{[this](auto z, auto result) { multiply(z, result); },
                     [this](auto r, auto s) { precondition(r, s); },
                     rhs_,
                     equations_,
                     lower_,
                     upper_,
                     tolerance_};
  return taut::solve(cloth_.mesh.comm, qp, effort, z_);
}

template<ConstraintSet Set>
void ContactQp<Set>::take_set(QpGuess guess) {
  set_rows_ = set_->rows();
  equations_ = bound_rows(*set_, lower_, upper_);
  z_.assign(set_rows_, 0.0);
  rhs_.resize(set_rows_);
  tolerance_.resize(set_rows_);
  if (guess == QpGuess::last_step) set_->program_guess(z_);
  set_->program_residual(rhs_);
  set_->program_tolerance(program_strain_left, tolerance_);
}

template<ConstraintSet Set>
void ContactQp<Set>::add_block(const Contact& contact) {
  Block block{0, 0};
  for (int i = 0; i < 4; ++i) {
    const Local v = contact.vertices[i];
    const bool is_cloth = v < search_.own() || v >= search_.home();
    if (!is_cloth || contact.weights[i] == 0) continue;
    contact_.parts.push_back({v, contact.weights[i]});
    ++block.parts;
  }
  contact_.blocks.push_back(block);
}

template<ConstraintSet Set>
void ContactQp<Set>::take_rows(std::span<const Contact> contacts, std::span<const ContactRow> rows) {
  auto& [blocks, parts, directions, inverse_diagonal, compliance] = contact_;
  blocks.clear();
  parts.clear();
  directions.clear();
  inverse_diagonal.clear();
  compliance.clear();
  Local last = -1;
  for (const ContactRow& row : rows) {
    const Contact& contact = contacts[row.contact];
    if (std::exchange(last, row.contact) != row.contact) add_block(contact);
    ++blocks.back().rows;
    directions.push_back(row.direction);
    rhs_.push_back(row.violation);
    lower_.push_back(row.lower);
    upper_.push_back(row.upper);
    tolerance_.push_back(row.slack);
    z_.push_back(row.guess);
    compliance.push_back((row.is_normal ? normal_compliance : friction_compliance) *
                         contact.inverse_effective_mass);
    inverse_diagonal.push_back(1 / (contact.inverse_effective_mass + compliance.back()));
  }
}

/// push_ = W R' z.
template<ConstraintSet Set>
void ContactQp<Set>::spread(std::span<const double> z) {
  const DistributedMesh& mesh = cloth_.mesh;
  set_->begin_spread(z.first(set_rows_));
  field_.assign(search_.size(), Vec3::Zero());
  const double* multiplier = z.data() + set_rows_;
  const Vec3* direction = contact_.directions.data();
  const Part* part = contact_.parts.data();
  for (const Block& block : contact_.blocks) {
    Vec3 force = Vec3::Zero();
    for (const Vec3* end = direction + block.rows; direction < end; ++direction)
      force += *multiplier++ * *direction;
    for (const Part* end = part + block.parts; part < end; ++part)
      field_[part->vertex] += part->weight * force;
  }
  set_->end_spread(field_); // own vertices come first in contact fields too
  search_.accumulate(field_);
  const auto inverse_mass = set_->inverse_mass();
  for (Local i = 0; i < mesh.vertices.owned; ++i)
    push_[i] = inverse_mass[i] * set_->freedom().allowed(i, field_[i]);
  mesh.vertex_halo.update(push_);
}

template<ConstraintSet Set>
void ContactQp<Set>::multiply(std::span<const double> z, std::span<double> result) {
  spread(z);
  std::copy(push_.begin(), push_.begin() + search_.own(), field_.begin());
  search_.update(field_);
  const auto compliance = set_->program_compliance();
  for (std::size_t r = 0; r < set_rows_; ++r) result[r] = compliance[r] * z[r];
  set_->subtract_difference(push_, result.first(set_rows_));
  std::size_t k = 0; // row
  const Part* part = contact_.parts.data();
  for (const Block& block : contact_.blocks) {
    Vec3 parting = Vec3::Zero();
    for (const Part* end = part + block.parts; part < end; ++part)
      parting += part->weight * field_[part->vertex];
    for (const std::size_t end = k + block.rows; k < end; ++k)
      result[set_rows_ + k] = contact_.directions[k].dot(parting) + contact_.compliance[k] * z[set_rows_ + k];
  }
}

template<ConstraintSet Set>
void ContactQp<Set>::precondition(std::span<const double> r, std::span<double> s) const {
  set_->precondition(r.first(set_rows_), s.first(set_rows_));
  for (std::size_t k = 0; k < contact_.inverse_diagonal.size(); ++k)
    s[set_rows_ + k] = r[set_rows_ + k] * contact_.inverse_diagonal[k];
}

template class ContactQp<EdgeSet>;
template class ContactQp<MetricSet>;
template class ContactQp<MixedSet>;
template class ContactQp<BoundedSet<MetricSet>>;
template class ContactQp<BoundedSet<MixedSet>>;

} // namespace taut
