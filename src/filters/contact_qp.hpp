#pragma once
#include "src/contact/rows.hpp"
#include "src/filters/edge_equations.hpp"
#include "src/linear/bounded_qp.hpp"
#include "src/linear/yarn_system.hpp"

namespace taut {

/// Edges as equations and contacts as inequalities, in one quadratic program for their multipliers,
///
///     minimise 1/2 z' (R W R' + A) z - b'z,   R = [-J; N],  W the inverse masses,
///
/// A the compliance: that of the edges, and a small part of the diagonal for contact rows, which may be
/// redundant. Matrix-free; preconditioned by the yarns' tridiagonal blocks and the contacts' diagonal.
/// (To take rows that hold a vertex fast out of the edges' blocks exactly costs more than it saves: it finds
/// the stresses in which edges and contacts only strain against each other, and these run into the bounds.)
class ContactQp {
public:
  /// Both must outlive it. Collective.
  ContactQp(const Cloth& cloth, const ContactSearch& search);

  /// Multipliers' increments of [owned edges; rows]; rows of one contact stand together. Collective.
  QpReport solve(const EdgeEquations& edges, std::span<const Contact> contacts,
                 std::span<const ContactRow> rows, const QpEffort& effort);

  std::span<const double> edge_part() const { return {z_.data(), edges_}; }
  std::span<const double> row_part() const { return {z_.data() + edges_, z_.size() - edges_}; }

  /// W R' z of the last solution, over local cloth vertices, ghosts current.
  std::span<const Vec3> push() const { return push_; }

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

  void add_block(const Contact& contact);
  void take_rows(std::span<const Contact> contacts, std::span<const ContactRow> rows);
  void precondition(std::span<const double> r, std::span<double> s) const;
  void multiply(std::span<const double> z, std::span<double> result);
  void spread(std::span<const double> z);

  const Cloth& cloth_;
  const ContactSearch& search_;
  YarnSystem yarns_;
  std::size_t edges_;                             ///< owned
  const EdgeEquations* edge_equations_ = nullptr; ///< of the program in hand
  std::vector<Block> blocks_;
  std::vector<Part> parts_;      ///< of all blocks
  std::vector<Vec3> directions_; ///< of rows
  std::vector<double> z_, rhs_, lower_, upper_, tolerance_;
  std::vector<double> row_diagonal_; ///< compliance in it
  std::vector<double> row_compliance_;
  std::vector<double> scaled_compliance_; ///< of owned edges; 1 where nothing can move
  std::vector<double> edge_values_;       ///< of local edges
  std::vector<Vec3> field_, push_;
};

} // namespace taut
