#pragma once
#include "src/linear/pattern.hpp"

namespace taut {

/// A symmetric positive semi-definite matrix between the velocities of vertices, in the form in which cloth
/// gives it,
///
///     A = B (x) I_3 + sum_k g_k g_k^T:
///
/// a scalar matrix B that acts on the three axes alike (mass, bending, tension, damping) and one vector g_k
/// over at most four vertices for every energy or dissipation of one scalar condition (shear, drag, stretch,
/// contact). It takes a quarter of the memory of its 3 x 3 blocks, and a product with it a quarter of the
/// time. Rows of owned vertices, columns of local ones; filled anew for every step, without communication.
class VertexMatrix {
public:
  struct RankOne {
    std::array<Local, 4> vertices; ///< all different; unused places repeat one and hold a zero gradient
    std::array<Vec3, 4> gradient;
  };

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
  void add_outer(const std::array<std::int32_t, n * n>& slots, const std::array<double, n>& w, double value) {
    for (std::size_t a = 0; a < n; ++a) {
      if (slots[a * n] < 0) continue;
      for (std::size_t b = 0; b < n; ++b) values_[slots[a * n + b]] += value * w[a] * w[b];
    }
  }

  /// A += g g^T.
  void add_rank_one(const std::array<Local, 4>& vertices, const std::array<Vec3, 4>& gradient) {
    rank_ones_.push_back({vertices, gradient});
  }

  const Pattern& pattern() const { return pattern_; }
  std::span<const double> values() const { return values_; } ///< of B, in the pattern's order
  std::span<const RankOne> rank_ones() const { return rank_ones_; }

  /// y = A x: `x` over local vertices with current ghosts; of `y`, over local vertices, the owned part is
  /// meaningful.
  void multiply(std::span<const Vec3> x, std::span<Vec3> y) const;

  /// The 3 x 3 blocks on the diagonal, of owned vertices.
  void diagonal_blocks(std::span<Mat3> blocks) const;

private:
  const Pattern& pattern_;
  std::vector<double> values_;
  std::vector<RankOne> rank_ones_;
};

} // namespace taut
