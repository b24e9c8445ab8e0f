#pragma once
#include "partition/types.hpp"

#include <cstddef>

namespace taut {

/// An entry of J: a row's part in the derivative by the squared length of an edge, as a factor of the
/// gradients of the set.
struct RowEdge {
  std::size_t row; ///< owned
  Local edge;      ///< local
  double factor;
};

} // namespace taut
