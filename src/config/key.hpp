#pragma once
#include "src/config/units.hpp"

#include <concepts>
#include <limits>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace taut::config {

/// T is S or const S: the reader changes what it visits, the others do not.
template<class T, class S>
concept Is = std::same_as<std::remove_const_t<T>, S>;

/// The values a number may have; the ends belong to it unless open.
struct Range {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  bool open_low = false;
  bool open_high = false;

  bool contains(double value) const;
  std::string text() const; ///< "above 0 and below 1"
};

inline constexpr Range positive{.low = 0, .open_low = true};
inline constexpr Range not_negative{.low = 0};
inline constexpr Range fraction{.low = 0, .high = 1, .open_low = true, .open_high = true};
constexpr Range at_least(double low) { return {.low = low}; }

enum class Presence { optional, required };

/// What is to be known of a key besides its name, its type and its default.
struct Key {
  Unit unit = Unit::none; ///< of the number, or of each number in a list
  Range range{};          ///< of the number, or of each number in a list
  Presence presence = Presence::optional;
  std::vector<std::string> words{};    ///< the words a string may be; empty: any
  std::string_view computed_default{}; ///< in words, when the default is not a constant
  std::string_view meaning{};          ///< one line
};

} // namespace taut::config
