#pragma once
#include "partition/types.hpp"

#include <cstddef>
#include <cstdint>
#include <span>

namespace taut {

/// Where a scalar matrix has entries: rows of owned points, columns of local ones in ascending order. What it
/// shows must outlive it.
struct SparseRows {
  std::span<const std::int64_t> offsets; ///< those of row i are [offsets[i], offsets[i + 1])
  std::span<const Local> all_columns;

  Local size() const { return Local(offsets.size()) - 1; }
  std::span<const Local> columns(Local row) const {
    return all_columns.subspan(std::size_t(offsets[row]), std::size_t(offsets[row + 1] - offsets[row]));
  }
};

} // namespace taut
