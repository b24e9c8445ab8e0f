#pragma once
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace taut::config {

/// The word that `given` was probably meant to be: the one reached by the fewest typing errors (a letter too
/// many, too few, wrong, or two swapped), if these are few for the length of the word.
std::optional<std::string> nearest(std::string_view given, std::span<const std::string> words);

} // namespace taut::config
