#pragma once
#include "src/config/values.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace taut::garment {

/// What becomes of keys that nobody knows: a program may have its own, one who writes by hand has mistyped.
enum class UnknownKeys { passed_over, refused };

/// How the numbers of a pattern are to be read.
struct PatternStyle {
  UnknownKeys unknown = UnknownKeys::refused;
  double metres_per_unit = 1; ///< of a length without a unit of its own
};

/// A block of keys in a pattern. Everything throws `InputError` "place: path: message".
class PatternBlock {
public:
  /// Throws if the tree is no block, or holds a key that is not in `names` where that is refused.
  PatternBlock(const config::Tree& tree, std::string path, const std::vector<std::string>& names,
               UnknownKeys unknown);

  bool has(std::string_view name) const;        ///< and it is not null
  config::Spot at(std::string_view name) const; ///< throws if it is not there
  config::Spot spot() const;

  std::string text(std::string_view name) const; ///< empty without the key

private:
  const config::Tree& tree_;
  std::string path_;
};

/// A list, of `least` entries at least.
const std::vector<config::Tree>& list_at(const config::Spot& spot, std::size_t least, std::string_view what);

double number_at(const config::Spot& spot);

/// In m; a number without a unit is one of the pattern.
double length_at(const config::Spot& spot, const PatternStyle& style);

/// From 0 to `count` - 1; `what` is counted.
int index_at(const config::Spot& spot, std::size_t count, std::string_view what);

/// true, false, 1 or 0.
bool flag_at(const config::Spot& spot);

/// The place in `names` of the word at the spot; throws "there is no `what` 'x' (did you mean 'y'?)".
std::size_t name_at(const config::Spot& spot, const std::vector<std::string>& names, std::string_view what);

} // namespace taut::garment
