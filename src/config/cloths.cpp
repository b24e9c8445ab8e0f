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

/// Names of the things in a list, of those that have one.
template<class T>
std::vector<std::string> names_of(const std::vector<T>& things) {
  std::vector<std::string> names;
  for (const T& thing : things)
    if (thing.name) names.push_back(*thing.name);
  return names;
}

/// By name, or by number.
template<class T>
std::optional<std::size_t> find(const std::vector<T>& things, const std::string& name) {
  const auto found = std::find_if(things.begin(), things.end(), [&](const T& t) { return t.name == name; });
  if (found != things.end()) return found - things.begin();
  const auto number = whole_number(name);
  return number && *number < things.size() ? number : std::nullopt;
}

template<class T>
std::string no_such(const char* kind, const std::vector<T>& things, const std::string& name) {
  const auto names = names_of(things);
  const auto meant = nearest(name, names);
  if (things.empty()) return fmt::format("there is no {} '{}': the case has none", kind, name);
  const std::string numbers = fmt::format("a number from 0 to {}", things.size() - 1);
  return fmt::format("there is no {} '{}'{}; give {}{}{}", kind, name,
                     meant ? fmt::format(" (did you mean '{}'?)", *meant) : "", fmt::join(names, ", "),
                     names.empty() ? "" : ", or ", numbers);
}

} // namespace

std::optional<std::size_t> find_cloth(const Case& input, const std::string& name) {
  return find(input.cloths, name);
}

std::optional<std::size_t> find_obstacle(const Case& input, const std::string& name) {
  return find(input.obstacles, name);
}

std::string name_of_cloth(const Case& input, std::size_t k) {
  return input.cloths[k].name.value_or(fmt::format("cloth {}", k));
}

Material material_of(const Material& cloth, const Panel& panel) {
  Material m = cloth;
  if (panel.fabric) {
    m.bending_weft.reset();
    m.twist.reset();
  }
  const PanelMaterial& own = panel.material;
  m.density = own.density.value_or(m.density);
  m.bending = own.bending.value_or(m.bending);
  m.shear = own.shear.value_or(m.shear);
  if (own.bending_weft) m.bending_weft = own.bending_weft;
  if (own.twist) m.twist = own.twist;
  if (own.stretch) m.stretch = own.stretch;
  if (own.stretch_weft) m.stretch_weft = own.stretch_weft;
  return m;
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
      return Fault{fmt::format("pins.{}.cloth", p), no_such("cloth", input.cloths, *name)};
  return std::nullopt;
}

std::optional<Fault> fault_of_attachments(const Case& input) {
  for (std::size_t k = 0; k < input.attachments.size(); ++k)
    if (const auto& name = input.attachments[k].obstacle; name && !find_obstacle(input, *name))
      return Fault{fmt::format("attachments.{}.obstacle", k), no_such("obstacle", input.obstacles, *name)};
  return std::nullopt;
}

} // namespace taut::config
