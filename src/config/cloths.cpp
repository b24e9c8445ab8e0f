#include "src/config/cloths.hpp"

#include "src/config/suggest.hpp"

#include <algorithm>
#include <charconv>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace taut::config {

namespace {

std::optional<std::size_t> whole_number(const std::string& text) {
  std::size_t number = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, number);
  if (error != std::errc{} || stop != end) return std::nullopt;
  return number;
}

/// What is wrong with the name of cloth `k`; empty if nothing is.
std::string fault_of_name(const Case& input, std::size_t k) {
  const std::string& name = *input.cloths[k].name;
  if (name.empty()) return "must not be empty; a cloth without a name is called by its number";
  if (whole_number(name))
    return "must not be a number; cloths have theirs already, from 0 in the order of the list";
  for (std::size_t j = 0; j < k; ++j)
    if (input.cloths[j].name == name)
      return fmt::format("'{}' is the name of cloths.{} already; give each its own", name, j);
  return "";
}

std::string no_such_cloth(const Case& input, const std::string& name) {
  std::vector<std::string> names;
  for (const Cloth& c : input.cloths)
    if (c.name) names.push_back(*c.name);
  const auto meant = nearest(name, names);
  const std::string numbers = fmt::format("a number from 0 to {}", input.cloths.size() - 1);
  return fmt::format("there is no cloth '{}'{}; give {}{}{}", name,
                     meant ? fmt::format(" (did you mean '{}'?)", *meant) : "", fmt::join(names, ", "),
                     names.empty() ? "" : ", or ", numbers);
}

} // namespace

std::optional<std::size_t> find_cloth(const Case& input, const std::string& name) {
  const auto& cloths = input.cloths;
  const auto found =
      std::find_if(cloths.begin(), cloths.end(), [&](const Cloth& c) { return c.name == name; });
  if (found != cloths.end()) return found - cloths.begin();
  const auto number = whole_number(name);
  return number && *number < cloths.size() ? number : std::nullopt;
}

std::string name_of_cloth(const Case& input, std::size_t k) {
  return input.cloths[k].name.value_or(fmt::format("cloth {}", k));
}

std::string key_of_cloth(const Case& input, std::size_t k) {
  return input.cloths.size() == 1 ? "cloth" : fmt::format("cloths.{}", k);
}

std::optional<Fault> fault_of_cloths(const Case& input) {
  for (std::size_t k = 0; k < input.cloths.size(); ++k) {
    if (!input.cloths[k].name) continue;
    if (const std::string fault = fault_of_name(input, k); !fault.empty())
      return Fault{key_of_cloth(input, k) + ".name", fault};
  }
  for (std::size_t p = 0; p < input.pins.size(); ++p)
    if (const auto& name = input.pins[p].cloth; name && !find_cloth(input, *name))
      return Fault{fmt::format("pins.{}.cloth", p), no_such_cloth(input, *name)};
  return std::nullopt;
}

} // namespace taut::config
