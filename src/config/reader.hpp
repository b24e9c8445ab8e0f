#pragma once
#include "src/config/describe.hpp"
#include "src/config/values.hpp"

#include <initializer_list>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace taut::config {

/// Visitor: collects the names of the keys of one struct.
class Names {
public:
  template<class T>
  void operator()(std::string_view name, const T&, const Key&) {
    list_.emplace_back(name);
  }
  template<class T>
  void one_or_list(std::string_view one, std::string_view list, const std::vector<T>&, const Key&) {
    list_.insert(list_.end(), {std::string(one), std::string(list)});
  }
  void exactly_one(std::initializer_list<std::string_view>) {}
  void check(std::string_view, bool, std::string_view) {}

  const std::vector<std::string>& list() const { return list_; }

private:
  std::vector<std::string> list_;
};

/// Visitor: fills one struct from a map of the tree. A key that is absent leaves the member as it is.
class Reader {
public:
  /// Throws if `spot` is not a map or holds a key that is not in `names`.
  Reader(const Spot& spot, const std::vector<std::string>& names);

  template<class T>
  void operator()(std::string_view name, T& value, const Key& key);
  template<class T>
  void one_or_list(std::string_view one, std::string_view list, std::vector<T>& values, const Key& key);
  void exactly_one(std::initializer_list<std::string_view> names);
  void check(std::string_view name, bool holds, std::string_view cure) const;

private:
  std::string path_of(std::string_view name) const;
  [[noreturn]] void fail(const std::string& message) const; ///< for the map as a whole
  [[noreturn]] void fail_missing(std::string_view name, const Key& key) const;

  Tree map_;
  std::string path_;
};

template<class Struct>
void read_keys(const Spot& spot, Struct& value) {
  Names names;
  describe(names, value);
  Reader reader(spot, names.list());
  describe(reader, value);
}

template<class Struct>
void read(const Spot& spot, Struct& value) requires std::is_class_v<Struct> {
  read_keys(spot, value);
}

/// A vector, or a list of keyframes.
void read(const Spot& spot, Gravity& value);

/// A fabric fills the material before the keys of that are read.
void read(const Spot& spot, Cloth& value);
void read(const Spot& spot, Panel& value);

template<class Choice>
void read(const Spot& spot, Choice& value) requires std::is_enum_v<Choice> {
  constexpr auto views = words_of(Choice{});
  const std::vector<std::string> words(views.begin(), views.end());
  value = static_cast<Choice>(read_word(spot, words));
}

template<class T>
void read(const Spot& spot, std::vector<T>& values);

/// Of things by name.
template<class T>
void read(const Spot& spot, std::map<std::string, T>& values);

template<class T>
void read(const Spot& spot, std::optional<T>& value) {
  if (!value) value.emplace();
  read(spot, *value);
}

template<class T>
void read(const Spot& spot, std::vector<T>& values) {
  if (spot.tree.kind != Tree::Kind::list) fail_type(spot, "a list in [ ], or lines that begin with '- '");
  values.clear();
  for (std::size_t i = 0; i < spot.tree.items.size(); ++i) {
    T value{};
    read(spot.item(i), value);
    values.push_back(std::move(value));
  }
}

template<class T>
void read(const Spot& spot, std::map<std::string, T>& values) {
  if (spot.tree.kind != Tree::Kind::map) fail_type(spot, "a block of names");
  values.clear();
  for (const Entry& entry : spot.tree.entries)
    read(Spot{entry.value, spot.path + "." + entry.key, spot.key}, values[entry.key]);
}

template<class T>
void Reader::operator()(std::string_view name, T& value, const Key& key) {
  const Entry* entry = map_.find(name);
  if (entry)
    read(Spot{entry->value, path_of(name), key}, value);
  else if (key.presence == Presence::required)
    fail_missing(name, key);
}

template<class T>
void Reader::one_or_list(std::string_view one, std::string_view list, std::vector<T>& values,
                         const Key& key) {
  exactly_one({one, list});
  if (!map_.find(one)) return (*this)(list, values, key);
  values.assign(1, T{});
  (*this)(one, values.front(), key);
}

} // namespace taut::config
