#include "src/config/tree.hpp"
#include "partition/error.hpp"
#include "src/config/one_document.hpp"

#include <algorithm>
#include <boost/locale/utf.hpp>
#include <charconv>
#include <fmt/format.h>
#include <functional>
#include <yaml-cpp/yaml.h>

namespace taut::config {

namespace {

using Place = std::function<std::string(const YAML::Mark&)>;

Place place_in_file(const std::string& name) {
  return [name](const YAML::Mark& m) {
    return fmt::format("{}:{}:{}", name, std::max(m.line, 0) + 1, std::max(m.column, 0) + 1);
  };
}

/// UTF-8 without control characters but tab and line feed, which alone is written and read again as it was.
bool is_text(const std::string& bytes) {
  namespace utf = boost::locale::utf;
  for (auto at = bytes.begin(); at != bytes.end();) {
    const utf::code_point c = utf::utf_traits<char>::decode(at, bytes.end());
    const bool is_control = (c < 0x20 && c != '\t' && c != '\n') || c == 0x7f;
    if (is_control || !utf::is_valid_codepoint(c)) return false;
  }
  return true;
}

/// Deeper than any case; an alias that holds itself has no end.
constexpr int deepest = 50;

/// Values that aliases may add; aliases of aliases multiply without limit.
constexpr std::size_t most_copies = 100000;

class Converter {
public:
  Converter(Place place, Origin origin, std::size_t most)
      : place_(std::move(place)), origin_(origin), most_(most) {}

  Tree convert(const YAML::Node& node, int depth = 0) {
    Tree tree;
    tree.place = place_(node.Mark());
    if (depth > deepest) throw InputError(tree.place + ": nested too deep; a few levels are enough");
    if (++count_ > most_)
      throw InputError(tree.place + ": aliases (*) stand for too many values; write them out");
    if (node.IsScalar()) {
      tree.kind = Tree::Kind::scalar;
      tree.text = text_of(node, tree.place);
    } else if (node.IsSequence()) {
      tree.kind = Tree::Kind::list;
      for (const auto& item : node) tree.items.push_back(convert(item, depth + 1));
    } else if (node.IsMap()) {
      tree.kind = Tree::Kind::map;
      for (const auto& pair : node) add(tree, pair.first, convert(pair.second, depth + 1));
    }
    return tree;
  }

private:
  static std::string text_of(const YAML::Node& scalar, const std::string& place) {
    if (!is_text(scalar.Scalar()))
      throw InputError(place + ": not text: there are bytes here that are no printable UTF-8; remove them");
    return scalar.Scalar();
  }

  void add(Tree& map, const YAML::Node& key, Tree value) const {
    const std::string place = place_(key.Mark());
    if (!key.IsScalar()) throw InputError(place + ": a key must be a word");
    const std::string name = text_of(key, place);
    if (const Entry* first = map.find(name))
      throw InputError(
          fmt::format("{}: key '{}' is given twice (first at {}); remove one", place, name, first->place));
    if (value.kind == Tree::Kind::nothing) value.place = place; // its own place is that of what follows
    map.entries.push_back({name, place, origin_, std::move(value)});
  }

  Place place_;
  Origin origin_;
  std::size_t most_, count_ = 0; ///< of values, each copy counted
};

Tree parse(const std::string& text, const Place& place, Origin origin) {
  try {
    if (const auto second = second_document(text))
      throw InputError(place(*second) +
                       ": a second document starts here; a file holds only one, so check --- and brackets");
    return Converter(place, origin, text.size() + most_copies).convert(YAML::Load(text));
  } catch (const YAML::Exception& e) {
    throw InputError(fmt::format("{}: not YAML: {}; check indentation, colons, brackets and quotes here",
                                 place(e.mark), e.msg));
  }
}

/// "pins[0].box" and "pins.0.box" are the same path.
std::vector<std::string> split(const std::string& key) {
  std::vector<std::string> parts{""};
  for (const char c : key) {
    if (c == '.' || c == '[')
      parts.emplace_back();
    else if (c != ']')
      parts.back() += c;
  }
  return parts;
}

bool is_index(const std::string& part) {
  return !part.empty() && std::all_of(part.begin(), part.end(), [](char c) { return c >= '0' && c <= '9'; });
}

Tree& list_item(Tree& list, const std::string& part, const std::string& place) {
  std::size_t index = 0;
  const auto end = part.data() + part.size();
  const auto [stop, error] = std::from_chars(part.data(), end, index);
  if (error != std::errc{} || stop != end || index >= list.items.size())
    throw InputError(fmt::format("{}: '{}' is not an entry of the list, which has {}; count from 0", place,
                                 part, list.items.size()));
  return list.items[index];
}

Tree& map_value(Tree& map, const std::string& part, const std::string& place) {
  if (Entry* entry = map.find(part)) return entry->value;
  Tree missing;
  missing.place = place;
  map.entries.push_back({part, place, Origin::override, std::move(missing)});
  return map.entries.back().value;
}

Tree& descend(Tree& tree, const std::string& part, const std::string& place) {
  if (tree.kind == Tree::Kind::list) return list_item(tree, part, place);
  if (tree.kind == Tree::Kind::scalar)
    throw InputError(fmt::format("{}: there is no '{}' below {}", place, part, tree.found()));
  if (is_index(part))
    throw InputError(fmt::format("{}: there is no entry {} to change; add it to the case file", place, part));
  tree.kind = Tree::Kind::map;
  return map_value(tree, part, place);
}

} // namespace

const Entry* Tree::find(std::string_view key) const {
  for (const Entry& e : entries)
    if (e.key == key) return &e;
  return nullptr;
}

Entry* Tree::find(std::string_view key) {
  for (Entry& e : entries)
    if (e.key == key) return &e;
  return nullptr;
}

const Tree& find_deepest(const Tree& tree, std::string_view path) {
  const Tree* at = &tree;
  for (const std::string& part : split(std::string(path))) {
    std::size_t index = 0;
    if (at->kind == Tree::Kind::list) std::from_chars(part.data(), part.data() + part.size(), index);
    const Entry* entry = at->find(part);
    if (entry)
      at = &entry->value;
    else if (at->kind == Tree::Kind::list && index < at->items.size())
      at = &at->items[index];
    else
      break;
  }
  return *at;
}

std::string Tree::found() const {
  switch (kind) {
  case Kind::scalar:
    return fmt::format("'{}'", text);
  case Kind::list:
    return fmt::format("a list of {}", items.size());
  case Kind::map:
    return "a block of keys";
  case Kind::nothing:
    break;
  }
  return "nothing";
}

Tree parse_document(const std::string& text, const std::string& file_name) {
  return parse(text, place_in_file(file_name), Origin::file);
}

Tree parse_case(const std::string& text, const std::string& file_name) {
  Tree root = parse_document(text, file_name);
  if (root.kind == Tree::Kind::nothing)
    throw InputError(root.place + ": the case is empty; give at least 'cloth'");
  if (root.kind != Tree::Kind::map)
    throw InputError(fmt::format("{}: expected keys such as 'cloth:', found {}", root.place, root.found()));
  return root;
}

void apply_override(Tree& root, const std::string& key, const std::string& value) {
  const std::string place = fmt::format("--set {}={}", key, value);
  Tree* target = &root;
  for (const std::string& part : split(key)) target = &descend(*target, part, place);
  *target = parse(
      value, [&](const YAML::Mark&) { return place; }, Origin::override);
}

} // namespace taut::config
