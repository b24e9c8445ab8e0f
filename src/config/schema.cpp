#include "src/config/schema.hpp"
#include "src/config/describe.hpp"

#include <cmath>
#include <fmt/format.h>
#include <initializer_list>
#include <map>

namespace taut {

namespace config {

namespace {

using Json = nlohmann::ordered_json;

/// Whole numbers without a decimal point.
Json json_of(double value) {
  if (std::abs(value) < 1e15 && std::trunc(value) == value) return static_cast<Global>(value);
  return value;
}
Json json_of(int value) { return value; }
Json json_of(bool value) { return value; }
Json json_of(const std::string& value) { return value; }
Json json_of(const Vec2& value) { return Json::array({json_of(value.x()), json_of(value.y())}); }
Json json_of(const Vec3& value) {
  return Json::array({json_of(value.x()), json_of(value.y()), json_of(value.z())});
}
Json json_of(const std::array<int, 2>& value) { return value; }

Json json_of(const Gravity& value) { return json_of(value.keyframes.front().value); }

template<class Choice>
Json json_of(Choice value) requires std::is_enum_v<Choice> {
  return words_of(value)[static_cast<std::size_t>(value)];
}

template<class T>
Json json_of(const std::vector<T>& values) {
  Json list = Json::array();
  if constexpr (requires(const T& value) { json_of(value); })
    for (const T& value : values) list.push_back(json_of(value));
  return list;
}

void add_range(Json& schema, const Range& range) {
  if (!std::isinf(range.low)) schema[range.open_low ? "exclusiveMinimum" : "minimum"] = json_of(range.low);
  if (!std::isinf(range.high)) schema[range.open_high ? "exclusiveMaximum" : "maximum"] = json_of(range.high);
}

Json row_of(std::size_t size, Json items) {
  return {{"type", "array"}, {"items", std::move(items)}, {"minItems", size}, {"maxItems", size}};
}

/// A quantity is a number, or a text with a unit.
Json type_of(double, const Key& key) {
  Json schema{{"type", {"number", "string"}}};
  add_range(schema, key.range);
  return schema;
}

Json type_of(Global, const Key& key) {
  Json schema{{"type", "integer"}};
  add_range(schema, key.range);
  return schema;
}

Json type_of(int, const Key& key) { return type_of(Global{}, key); }
Json type_of(bool, const Key&) { return {{"type", "boolean"}}; }
Json type_of(const Vec2&, const Key& key) { return row_of(2, type_of(0.0, key)); }
Json type_of(const Vec3&, const Key& key) { return row_of(3, type_of(0.0, key)); }
Json type_of(const std::array<int, 2>&, const Key& key) { return row_of(2, type_of(0, key)); }
Json type_of(const std::filesystem::path&, const Key&) { return {{"type", "string"}, {"minLength", 1}}; }

Json type_of(const std::string&, const Key& key) {
  Json schema{{"type", "string"}};
  if (!key.words.empty()) schema["enum"] = key.words;
  return schema;
}

template<class Choice>
Json type_of(Choice, const Key&) requires std::is_enum_v<Choice> {
  return {{"type", "string"}, {"enum", words_of(Choice{})}};
}

template<class Struct>
Json type_of(const Struct& value, const Key&) requires std::is_class_v<Struct>;

template<class T>
Json type_of(const std::vector<T>&, const Key& key);

template<class T>
Json type_of(const std::map<std::string, T>&, const Key& key);

Json type_of(const Gravity& value, const Key& key) {
  return {{"anyOf", {type_of(Vec3(), key), type_of(value.keyframes, key)}}};
}

template<class T>
Json type_of(const std::optional<T>& value, const Key& key) {
  return type_of(value.value_or(T{}), key);
}

template<class T>
Json type_of(const std::vector<T>&, const Key& key) {
  return {{"type", "array"}, {"items", type_of(T{}, key)}};
}

template<class T>
Json type_of(const std::map<std::string, T>&, const Key& key) {
  return {{"type", "object"}, {"additionalProperties", type_of(T{}, key)}};
}

/// Visitor: the schema of one struct; the values it visits are the defaults.
class SchemaWriter {
public:
  template<class T>
  void operator()(std::string_view name, const T& value, const Key& key) {
    Json schema{{"description", key.meaning}};
    schema.update(type_of(value, key));
    if (key.unit != Unit::none) schema["x-unit"] = name_of(key.unit).symbol;
    if (key.presence == Presence::required)
      required_.push_back(name);
    else if (!key.computed_default.empty())
      schema["x-default"] = key.computed_default;
    else if constexpr (requires { json_of(value); })
      schema["default"] = json_of(value);
    properties_[std::string(name)] = std::move(schema);
  }
  /// Of the whole case: the reference begins at the root.
  template<class T>
  void one_or_list(std::string_view one, std::string_view list, const std::vector<T>&, const Key& key) {
    exactly_one({one, list});
    (*this)(one, T{}, key);
    properties_[std::string(list)] = {{"description", fmt::format("several, as `{}`", one)},
                                      {"type", "array"},
                                      {"items", {{"$ref", fmt::format("#/properties/{}", one)}}},
                                      {"minItems", 1}};
  }
  void exactly_one(std::initializer_list<std::string_view> names) {
    for (const std::string_view name : names) one_of_.push_back({{"required", {name}}});
  }
  void check(std::string_view, bool, std::string_view) {}

  Json schema() const {
    Json schema{{"type", "object"}, {"properties", properties_}, {"additionalProperties", false}};
    if (!required_.empty()) schema["required"] = required_;
    if (!one_of_.empty()) schema["oneOf"] = one_of_;
    return schema;
  }

private:
  Json properties_ = Json::object();
  Json required_ = Json::array();
  Json one_of_ = Json::array();
};

template<class Struct>
Json type_of(const Struct& value, const Key&) requires std::is_class_v<Struct> {
  SchemaWriter writer;
  describe(writer, value);
  return writer.schema();
}

} // namespace

nlohmann::ordered_json schema() {
  Json schema{{"$schema", "https://json-schema.org/draft/2020-12/schema"}, {"title", "A case of Taut"}};
  schema.update(type_of(Case{}, Key{}));
  return schema;
}

} // namespace config

std::string case_schema() { return config::schema().dump(2) + "\n"; }

} // namespace taut
