#pragma once
#include "partition/distributed_mesh.hpp"
#include "src/linear/sparse_rows.hpp"

namespace taut {

/// Which vertices act on which: the rows of owned vertices, over local columns, of every matrix between
/// vertices. Two vertices are coupled if they share a cell, a yarn triple or a hinge. Fixed for a mesh.
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

  /// The slots of all pairs of a stencil's vertices, row by row.
  template<std::size_t n>
  std::array<std::int32_t, n * n> slots(const std::array<Local, n>& vertices) const {
    std::array<std::int32_t, n * n> result;
    for (std::size_t a = 0; a < n; ++a)
      for (std::size_t b = 0; b < n; ++b) result[a * n + b] = std::int32_t(slot(vertices[a], vertices[b]));
    return result;
  }

private:
  std::vector<std::int64_t> offsets_{0};
  std::vector<Local> columns_;
  std::vector<std::int32_t> diagonal_;
};

} // namespace taut
