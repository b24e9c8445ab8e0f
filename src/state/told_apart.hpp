#pragma once
#include <fmt/format.h>

#include <string>

namespace taut {

/// A number of a message beside a limit that it is beyond: with three digits, or as many as it takes to be
/// seen to differ.
inline std::string told_apart(double value, double limit) {
  int digits = 3;
  while (digits < 17 && fmt::format("{:.{}g}", value, digits) == fmt::format("{:.{}g}", limit, digits))
    ++digits;
  return fmt::format("{:.{}g}", value, digits);
}

} // namespace taut
