#pragma once
#include "src/linear/contact_couplings.hpp"
#include "src/linear/pattern.hpp"

#include <optional>

namespace taut {

/// A symmetric positive semi-definite matrix between the velocities of vertices, in the form in which cloth
/// gives it,
///
///     A = B (x) I_3 + sum_k g_k g_k^T:
///
/// a scalar matrix B that acts on the three axes alike (mass, bending, tension, damping) and one vector g_k
/// over at most six vertices for every energy or dissipation of one scalar condition (shear, drag, stretch,
/// folding, contact). It takes a quarter of the memory of its 3 x 3 blocks, and a product with it a quarter
/// of the time. Rows of owned vertices, columns of local ones; filled anew for every step, without
/// communication. Terms between vertices that are not neighbours are kept apart, as ContactCouplings.
class VertexMatrix {
public:
  /// Vertices all different; unused places repeat one and hold a zero gradient. Most conditions have four
  /// vertices; only a hinge beside a quad has more.
  template<std::size_t n>
  struct RankOneOver {
    std::array<Local, n> vertices;
    std::array<Vec3, n> gradient;
  };
  using RankOne = RankOneOver<4>;
  using WideRankOne = RankOneOver<6>;

  /// `pattern` must outlive the matrix.
  explicit VertexMatrix(const Pattern& pattern) : pattern_(pattern), values_(pattern.entries(), 0.0) {}

  /// Forgets all values; keeps the memory.
  void clear();

  /// B(i, i) += value, for an owned vertex i.
  void add_diagonal(Local vertex, double value) { values_[pattern_.diagonal(vertex)] += value; }

  /// Adds to the entry of B kept at `slot`.
  void add_entry(std::int32_t slot, double value) { values_[slot] += value; }

  /// B += value w w^T over a stencil's vertices, whose slots are `pattern.slots(vertices)`. Rows of ghosts
  /// are dropped.
  template<std::size_t n>
  void add_outer(const std::array<Local, n>& vertices, const Pattern::Slots<n>& slots,
                 const std::array<double, n>& w, double value) {
    for (std::size_t a = 0; a < n; ++a) {
      if (vertices[a] >= pattern_.rows()) continue;
      double* const row = values_.data() + pattern_.offset(vertices[a]);
      for (std::size_t b = 0; b < n; ++b) row[slots[a * n + b]] += value * w[a] * w[b];
    }
  }

  /// A += g g^T.
  void add_rank_one(const std::array<Local, 4>& vertices, const std::array<Vec3, 4>& gradient) {
    rank_ones_.push_back({vertices, gradient});
  }
  void add_rank_one(const std::array<Local, 6>& vertices, const std::array<Vec3, 6>& gradient) {
    wide_rank_ones_.push_back({vertices, gradient});
  }

  /// A += the terms, in place of those set before.
  void set_far(ContactCouplings terms) { far_ = std::move(terms); }
  /// A += g g^T of each, in place of those set before.
  void set_near(std::vector<RankOne> terms) { near_ = std::move(terms); }
  const std::optional<ContactCouplings>& far() const { return far_; }

  const Pattern& pattern() const { return pattern_; }
  std::span<const double> values() const { return values_; } ///< of B, in the pattern's order

  /// Calls visit(g) for every g_k, a RankOne or a WideRankOne.
  template<class Visit>
  void for_each_rank_one(Visit&& visit) const {
    for (const RankOne& r : rank_ones_) visit(r);
    for (const RankOne& r : near_) visit(r);
    for (const WideRankOne& r : wide_rank_ones_) visit(r);
  }

  /// y = A x: `x` over local vertices with current ghosts; of `y`, over local vertices, the owned part is
  /// meaningful. Collective over neighbours if there are far terms.
  void multiply(std::span<const Vec3> x, std::span<Vec3> y) const;

  /// The 3 x 3 blocks on the diagonal, of owned vertices.
  void diagonal_blocks(std::span<Mat3> blocks) const;

private:
  const Pattern& pattern_;
  std::vector<double> values_;
  std::vector<RankOne> rank_ones_, near_;
  std::vector<WideRankOne> wide_rank_ones_;
  std::optional<ContactCouplings> far_;
};

} // namespace taut
