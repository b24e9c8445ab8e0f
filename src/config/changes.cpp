#include "src/config/changes.hpp"

#include "src/config/tree.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace taut {

namespace {

using config::Tree;

struct Leaf {
  std::string key, value;
};

bool is_row(const Tree& list) {
  return std::all_of(list.items.begin(), list.items.end(),
                     [](const Tree& item) { return item.kind == Tree::Kind::scalar; });
}

/// A row of scalars is one value.
void flatten(const Tree& tree, const std::string& key, std::vector<Leaf>& leaves) {
  const auto below = [&](const std::string& part) { return key.empty() ? part : key + "." + part; };
  if (tree.kind == Tree::Kind::map) {
    for (const config::Entry& e : tree.entries) flatten(e.value, below(e.key), leaves);
  } else if (tree.kind == Tree::Kind::list && !is_row(tree)) {
    for (std::size_t i = 0; i < tree.items.size(); ++i)
      flatten(tree.items[i], below(std::to_string(i)), leaves);
  } else if (tree.kind == Tree::Kind::list) {
    std::vector<std::string> items;
    for (const Tree& item : tree.items) items.push_back(item.text);
    leaves.push_back({key, fmt::format("[{}]", fmt::join(items, ", "))});
  } else {
    leaves.push_back({key, tree.text});
  }
}

std::vector<Leaf> leaves_of(const Case& input) {
  std::vector<Leaf> leaves;
  flatten(config::parse_case(write_case(input), input.file.string()), "", leaves);
  return leaves;
}

const std::string* value_of(const std::string& key, const std::vector<Leaf>& leaves) {
  const auto found = std::find_if(leaves.begin(), leaves.end(), [&](const Leaf& l) { return l.key == key; });
  return found == leaves.end() ? nullptr : &found->value;
}

} // namespace

std::vector<KeyChange> changes_between(const Case& before, const Case& after) {
  const std::vector<Leaf> old = leaves_of(before), present = leaves_of(after);
  std::vector<KeyChange> changes;
  for (const Leaf& l : old) {
    const std::string* now = value_of(l.key, present);
    if (!now || *now != l.value) changes.push_back({l.key, l.value, now ? *now : "none"});
  }
  for (const Leaf& l : present)
    if (!value_of(l.key, old)) changes.push_back({l.key, "none", l.value});
  return changes;
}

} // namespace taut
