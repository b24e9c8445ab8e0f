#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace taut::config {

struct Entry;

/// A YAML document as plain data. Every piece knows the place it came from, in the words of messages:
/// "file:line:column" or "--set key=value".
struct Tree {
  enum class Kind { nothing, scalar, list, map };

  Kind kind = Kind::nothing;
  std::string place;
  std::string text;           ///< of a scalar
  std::vector<Tree> items;    ///< of a list
  std::vector<Entry> entries; ///< of a map, in the order of the file; keys differ

  const Entry* find(std::string_view key) const; ///< nullptr if the map has no such key
  Entry* find(std::string_view key);
  std::string found() const; ///< what it is, for "expected ..., found ..."
};

/// The value below `tree` that a path such as "pins.1.cloth" leads to; where the path ends early, the last
/// one on it.
const Tree& find_deepest(const Tree& tree, std::string_view path);

/// Who wrote a key: an override takes the place of what stands in the file.
enum class Origin { file, override };

struct Entry {
  std::string key;
  std::string place; ///< of the key
  Origin origin;
  Tree value;
};

/// Throws `InputError` if `text` is not one YAML document, or keys of a map are the same. JSON is YAML, too.
Tree parse_document(const std::string& text, const std::string& file_name);

/// The same for a case: throws also if its root is not a map.
Tree parse_case(const std::string& text, const std::string& file_name);

/// Puts the value of `--set key=value` into `root`; blocks on the way that are missing are made.
void apply_override(Tree& root, const std::string& key, const std::string& value);

} // namespace taut::config
