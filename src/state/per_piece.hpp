#pragma once
#include <optional>
#include <utility>
#include <vector>

namespace taut {

/// A value for each piece of the cloth: of a material, say. None for a piece that it does not concern.
template<class T>
class PerPiece {
public:
  /// One for all pieces, however many there are.
  PerPiece(T all) : values_{std::move(all)}, for_all_(true) {}

  explicit PerPiece(std::vector<std::optional<T>> values) : values_(std::move(values)) {}

  const std::optional<T>& of(std::size_t piece) const { return values_[for_all_ ? 0 : piece]; }

  bool any() const {
    for (const auto& v : values_)
      if (v) return true;
    return false;
  }

private:
  std::vector<std::optional<T>> values_;
  bool for_all_ = false;
};

/// A value for each of Cloth::sections, in the same way.
template<class T>
using PerSection = PerPiece<T>;

} // namespace taut
