#pragma once
#include <cstddef>
#include <span>

namespace taut {

/// The rows of a set that is made of two, `first` of one and behind them those of the other.
struct RowParts {
  std::size_t first;

  template<class T>
  std::span<T> of_first(std::span<T> rows) const {
    return rows.first(first);
  }
  template<class T>
  std::span<T> of_second(std::span<T> rows) const {
    return rows.subspan(first);
  }
};

} // namespace taut
