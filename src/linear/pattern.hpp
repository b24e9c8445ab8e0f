#pragma once
#include "partition/distributed_mesh.hpp"
#include "src/linear/sparse_rows.hpp"

namespace taut {

/// Which vertices act on which: the rows of owned vertices, over local columns, of every matrix between
/// vertices. Two vertices are coupled if they share a cell, a yarn triple, a hinge or a patch of
/// triangles (see TrianglePatch). Fixed for a mesh.
class Pattern {
public:
  /// Not collective.
  explicit Pattern(const DistributedMesh& mesh);

  Local rows() const { return Local(offsets_.size()) - 1; }
  std::span<const Local> columns(Local row) const {
    return {columns_.data() + offsets_[row], std::size_t(offsets_[row + 1] - offsets_[row])};
  }
  SparseRows sparse_rows() const { return {offsets_, columns_}; }
  std::int64_t offset(Local row) const { return offsets_[row]; }
  std::int64_t entries() const { return offsets_.back(); }

  /// Where the entry (row, column) is kept; -1 if this rank does not own the row.
  std::int64_t slot(Local row, Local column) const;
  std::int64_t diagonal(Local row) const { return diagonal_[row]; }

  /// Where the entries of all pairs of a stencil's vertices are kept, row by row, counted from the first
  /// entry of their rows: there are many stencils, and rows are short. Of rows of other ranks, nothing.
  template<std::size_t n>
  using Slots = std::array<std::uint16_t, n * n>;

  template<std::size_t n>
  Slots<n> slots(const std::array<Local, n>& vertices) const {
    Slots<n> result{};
    for (std::size_t a = 0; a < n; ++a) {
      if (vertices[a] >= rows()) continue;
      for (std::size_t b = 0; b < n; ++b) result[a * n + b] = slot_in_row(vertices[a], vertices[b]);
    }
    return result;
  }

private:
  std::uint16_t slot_in_row(Local row, Local column) const;

  std::vector<std::int64_t> offsets_{0};
  std::vector<Local> columns_;
  std::vector<std::int32_t> diagonal_;
};

} // namespace taut
