#include "src/garment/pattern_block.hpp"

#include "partition/error.hpp"
#include "src/config/suggest.hpp"

#include <algorithm>
#include <cctype>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace taut::garment {

using config::Spot;
using config::Tree;

namespace {

const config::Key plain{}, length{.unit = config::Unit::metre};

std::string hint(const std::string& given, const std::vector<std::string>& names) {
  const auto meant = config::nearest(given, names);
  return meant ? fmt::format(" (did you mean '{}'?)", *meant) : "";
}

} // namespace

PatternBlock::PatternBlock(const Tree& tree, std::string path, const std::vector<std::string>& names,
                           UnknownKeys unknown)
    : tree_(tree), path_(std::move(path)) {
  if (tree.kind != Tree::Kind::map) config::fail_type(spot(), "a block of keys");
  if (unknown == UnknownKeys::passed_over) return;
  for (const config::Entry& e : tree.entries)
    if (std::ranges::find(names, e.key) == names.end())
      throw InputError(fmt::format("{}: unknown key '{}'{}; known here: {}", e.place, e.key,
                                   hint(e.key, names), fmt::join(names, ", ")));
}

bool PatternBlock::has(std::string_view name) const {
  const config::Entry* entry = tree_.find(name);
  return entry && entry->value.kind != Tree::Kind::nothing;
}

Spot PatternBlock::at(std::string_view name) const {
  if (!has(name)) spot().fail(fmt::format("'{}' is missing; add it", name));
  return {tree_.find(name)->value, fmt::format("{}.{}", path_, name), plain};
}

Spot PatternBlock::spot() const { return {tree_, path_, plain}; }

std::string PatternBlock::text(std::string_view name) const {
  std::string text;
  if (has(name)) config::read(at(name), text);
  return text;
}

const std::vector<Tree>& list_at(const Spot& spot, std::size_t least, std::string_view what) {
  if (spot.tree.kind != Tree::Kind::list || spot.tree.items.size() < least)
    config::fail_type(spot, fmt::format("a list of {}", what));
  return spot.tree.items;
}

double number_at(const Spot& spot) {
  double number = 0;
  config::read(spot, number);
  return number;
}

double length_at(const Spot& spot, const PatternStyle& style) {
  const std::string& text = spot.tree.text;
  const bool has_unit = !text.empty() && std::isalpha(static_cast<unsigned char>(text.back()));
  if (!has_unit && spot.tree.kind == Tree::Kind::scalar) return number_at(spot) * style.metres_per_unit;
  double number = 0;
  config::read(Spot{spot.tree, spot.path, length}, number);
  return number;
}

int index_at(const Spot& spot, std::size_t count, std::string_view what) {
  int index = 0;
  config::read(spot, index);
  if (index < 0 || std::size_t(index) >= count)
    spot.fail(fmt::format("there is no {} {}; they go from 0 to {}", what, index, count - 1));
  return index;
}

bool flag_at(const Spot& spot) {
  const std::string& text = spot.tree.text;
  const bool yes = text == "true" || text == "1", no = text == "false" || text == "0";
  if (spot.tree.kind != Tree::Kind::scalar || !(yes || no)) config::fail_type(spot, "true or false");
  return yes;
}

std::size_t name_at(const Spot& spot, const std::vector<std::string>& names, std::string_view what) {
  std::string name;
  config::read(spot, name);
  const auto found = std::ranges::find(names, name);
  if (found == names.end())
    spot.fail(fmt::format("there is no {} '{}'{}; there are {}", what, name, hint(name, names),
                          fmt::join(names, ", ")));
  return std::size_t(found - names.begin());
}

} // namespace taut::garment
