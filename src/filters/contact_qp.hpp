#pragma once
#include "src/constraints/constraint_set.hpp"
#include "src/contact/rows.hpp"
#include "src/linear/bounded_qp.hpp"

namespace taut {

/// Of the strain limit, by a program.
constexpr double program_strain_left = 0.2;

/// Where a program starts: at the multipliers that the last step took, or at none.
enum class QpGuess { last_step, zero };

/// The rows of a set of constraints and those of contacts, as equations and inequalities in one quadratic
/// program for the increments z of their multipliers,
///
///     minimise 1/2 z' (R W R' + A) z - b'z,   R = [-J; N],  W the inverse masses,
///
/// A the compliance: that of the set, and a small part of the diagonal for contact rows, which may be
/// redundant. Matrix-free; preconditioned as the set is and by the contacts' diagonal. (To take rows that
/// hold a vertex fast out of the edges' blocks exactly costs more than it saves: it finds the stresses in
/// which edges and contacts only strain against each other, and these run into the bounds.)
template<ConstraintSet Set>
class ContactQp {
public:
  /// Both must outlive it. Not collective.
  ContactQp(const Cloth& cloth, const ContactSearch& search);

  /// Multipliers' increments of [rows of the set; rows]; rows of one contact stand together. Collective.
  QpReport solve(Set& set, std::span<const Contact> contacts, std::span<const ContactRow> rows,
                 const QpEffort& effort, QpGuess guess);

  std::span<const double> set_part() const { return std::span(z_).first(set_rows_); }
  std::span<const double> row_part() const { return std::span(z_).subspan(set_rows_); }
  std::span<double> row_part() { return std::span(z_).subspan(set_rows_); }

  /// The same program with other bounds, which `limit(z, lower, upper)` gives for the rows of contacts and
  /// where it ended, from there on. Collective.
  template<class Limit>
  QpReport solve_on(const QpEffort& effort, Limit&& limit) {
    limit(row_part(), of_contacts(lower_), of_contacts(upper_));
    return solve(effort);
  }

  /// W R' z, over local cloth vertices, ghosts current. Collective.
  std::span<const Vec3> push() {
    spread(z_);
    return push_;
  }

private:
  /// A vertex of cloth in a contact.
  struct Part {
    Local vertex;
    double weight;
  };

  /// What a product needs of a contact: so many parts, so many rows.
  struct Block {
    Local parts, rows;
  };

  /// Of all rows of contacts.
  struct ContactPart {
    std::vector<Block> blocks;
    std::vector<Part> parts; ///< of all blocks
    std::vector<Vec3> directions;
    std::vector<double> inverse_diagonal; ///< compliance in it
    std::vector<double> compliance;
  };

  QpReport solve(const QpEffort& effort);
  std::span<double> of_contacts(std::vector<double>& bounds) const {
    return std::span(bounds).subspan(set_rows_ - equations_);
  }
  void take_set(QpGuess guess);
  void take_rows(std::span<const Contact> contacts, std::span<const ContactRow> rows);
  void add_block(const Contact& contact);
  void precondition(std::span<const double> r, std::span<double> s) const;
  void multiply(std::span<const double> z, std::span<double> result);
  void spread(std::span<const double> z);

  const Cloth& cloth_;
  const ContactSearch& search_;
  Set* set_ = nullptr; ///< of the program in hand
  std::size_t set_rows_ = 0, equations_ = 0;
  ContactPart contact_;
  std::vector<double> z_, rhs_, tolerance_;
  std::vector<double> lower_, upper_; ///< of one-sided rows of the set, and of contacts
  std::vector<Vec3> field_, push_;
};

} // namespace taut
