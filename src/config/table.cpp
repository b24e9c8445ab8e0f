#include "src/config/case.hpp"
#include "src/config/schema.hpp"

#include <algorithm>
#include <cctype>
#include <fmt/format.h>
#include <string>

namespace taut {

namespace {

using Json = nlohmann::ordered_json;

bool is_quantity(const Json& schema) { return schema.at("type").is_array(); }

/// What a value may be: of most keys one thing.
Json::array_t forms_of(const Json& schema) {
  return schema.contains("anyOf") ? schema["anyOf"].get<Json::array_t>() : Json::array_t{schema};
}

std::string range_of(const Json& schema) {
  std::string text;
  const auto add = [&](const char* name, const char* sign) {
    if (schema.contains(name))
      text += fmt::format("{} {} {}", text.empty() ? "" : ",", sign, schema[name].dump());
  };
  add("exclusiveMinimum", ">");
  add("minimum", ">=");
  add("exclusiveMaximum", "<");
  add("maximum", "<=");
  return text;
}

std::string words_of(const Json& schema) {
  std::string text;
  for (const Json& word : schema.at("enum"))
    text += fmt::format("{}`{}`", text.empty() ? "" : ", ", word.get<std::string>());
  return text;
}

/// "integer >= 2" becomes "integers >= 2"; choices and counted things stay.
std::string plural(const std::string& type) {
  if (!std::isalpha(static_cast<unsigned char>(type.front()))) return type;
  const std::size_t noun = std::min(type.find(' '), type.size());
  return fmt::format("{}s{}", type.substr(0, noun), type.substr(noun));
}

std::string type_of(const Json& schema) {
  if (const auto forms = forms_of(schema); forms.size() > 1)
    return fmt::format("{}, or {}", type_of(forms[0]), type_of(forms[1]));
  if (schema.contains("$ref")) {
    const auto path = schema.at("$ref").get<std::string>();
    return fmt::format("block as `{}`", path.substr(path.rfind('/') + 1));
  }
  if (is_quantity(schema)) return "number" + range_of(schema);
  const auto type = schema.at("type").get<std::string>();
  if (type == "array") {
    const std::string items = plural(type_of(schema.at("items")));
    return schema.contains("maxItems") ? schema["minItems"].dump() + " " + items : "list of " + items;
  }
  if (type == "object") return schema.at("additionalProperties").is_object() ? "block of names" : "block";
  if (type == "integer") return "integer" + range_of(schema);
  if (type == "boolean") return "`true`, `false`";
  return schema.contains("enum") ? words_of(schema) : "text";
}

enum class Need { required, one_of, free };

Need need_of(const Json& parent, const std::string& name) {
  const auto names = [&](const Json& list) {
    return std::find(list.begin(), list.end(), name) != list.end();
  };
  if (names(parent.value("required", Json::array()))) return Need::required;
  for (const Json& choice : parent.value("oneOf", Json::array()))
    if (names(choice.at("required"))) return Need::one_of;
  return Need::free;
}

std::string default_of(const Json& schema, Need need) {
  if (need == Need::required) return "required";
  if (need == Need::one_of) return "exactly one of these";
  if (schema.contains("x-default")) return schema["x-default"];
  if (schema.contains("default")) return fmt::format("`{}`", schema["default"].dump());
  return schema.value("type", "") == "object" ? "" : "none";
}

void add_rows(std::string& table, const Json& parent, const std::string& path) {
  for (const auto& [name, schema] : parent.at("properties").items()) {
    const std::string key = path + name;
    table += fmt::format("| `{}` | {} | {} | {} | {} |\n", key, type_of(schema), schema.value("x-unit", ""),
                         default_of(schema, need_of(parent, name)), schema.value("description", ""));
    if (schema.contains("properties")) add_rows(table, schema, key + ".");
    if (const auto of_names = schema.find("additionalProperties");
        of_names != schema.end() && of_names->is_object())
      add_rows(table, *of_names, key + ".NAME.");
    for (const Json& form : forms_of(schema))
      if (form.contains("items") && form["items"].contains("properties"))
        add_rows(table, form["items"], key + "[].");
  }
}

} // namespace

std::string case_table() {
  std::string table = "| key | type | unit | default | meaning |\n| --- | --- | --- | --- | --- |\n";
  add_rows(table, config::schema(), "");
  return table;
}

} // namespace taut
