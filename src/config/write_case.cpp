#include "src/config/describe.hpp"

#include <cmath>
#include <initializer_list>
#include <map>
#include <yaml-cpp/yaml.h>

namespace taut {

namespace config {

namespace {

std::string text_of(double value) {
  return fmt::format("{}", value);
} // the shortest text that reads back exactly
std::string text_of(int value) { return fmt::format("{}", value); }
std::string text_of(Global value) { return fmt::format("{}", value); }
std::string text_of(bool value) { return value ? "true" : "false"; }
std::string text_of(const std::string& value) { return value; }
std::string text_of(const std::filesystem::path& value) { return value.string(); }

template<class Choice>
std::string text_of(Choice value) requires std::is_enum_v<Choice> {
  return std::string(word_of(value));
}

template<class T>
concept Scalar = requires(const T& value) {
  text_of(value);
};

template<Scalar T>
void write(YAML::Emitter& out, const T& value) {
  out << text_of(value);
}

template<class Values>
void write_row(YAML::Emitter& out, const Values& values) {
  out << YAML::Flow << YAML::BeginSeq;
  for (const auto& value : values) write(out, value);
  out << YAML::EndSeq;
}

void write(YAML::Emitter& out, const Vec2& value) { write_row(out, value); }
void write(YAML::Emitter& out, const Vec3& value) { write_row(out, value); }
void write(YAML::Emitter& out, const std::array<int, 2>& value) { write_row(out, value); }

template<class Struct>
void write(YAML::Emitter& out, const Struct& value) requires(std::is_class_v<Struct> && !Scalar<Struct>);

template<class T>
void write(YAML::Emitter& out, const std::vector<T>& values) {
  if (Scalar<T> || std::same_as<T, Vec3> || values.empty()) out << YAML::Flow;
  out << YAML::BeginSeq;
  for (const T& value : values) write(out, value);
  out << YAML::EndSeq;
}

template<class T>
void write(YAML::Emitter& out, const std::map<std::string, T>& values) {
  if (values.empty()) out << YAML::Flow;
  out << YAML::BeginMap;
  for (const auto& [name, value] : values) {
    out << YAML::Key << name << YAML::Value;
    write(out, value);
  }
  out << YAML::EndMap;
}

void write(YAML::Emitter& out, const Gravity& value) {
  const auto& keyframes = value.keyframes;
  const bool is_vector = keyframes.size() == 1 && keyframes.front().time == 0;
  is_vector ? write(out, keyframes.front().value) : write(out, keyframes);
}

template<class T>
bool is_absent(const T&) {
  return false;
}

template<class T>
bool is_absent(const std::optional<T>& value) {
  return !value;
}

template<class T>
void write(YAML::Emitter& out, const std::optional<T>& value) {
  write(out, *value);
}

template<class T>
void write(YAML::Emitter& out, const T& value, const Key&) {
  write(out, value);
}

/// With its unit where it could not be read without (full_turn).
void write(YAML::Emitter& out, double value, const Key& key) {
  const bool is_large_angle = key.unit == Unit::radian && std::abs(value) > full_turn;
  out << text_of(value) + (is_large_angle ? " rad" : "");
}

/// Visitor: writes the keys of one struct.
class Writer {
public:
  explicit Writer(YAML::Emitter& out) : out_(out) {}

  template<class T>
  void operator()(std::string_view name, const T& value, const Key& key) {
    if (is_absent(value)) return;
    out_ << YAML::Key << std::string(name) << YAML::Value;
    write(out_, value, key);
    if (key.unit != Unit::none) out_ << YAML::Comment(std::string(name_of(key.unit).symbol));
  }
  template<class T>
  void one_or_list(std::string_view one, std::string_view list, const std::vector<T>& values,
                   const Key& key) {
    values.size() == 1 ? (*this)(one, values.front(), key) : (*this)(list, values, key);
  }
  void exactly_one(std::initializer_list<std::string_view>) {}
  void check(std::string_view, bool, std::string_view) {}

private:
  YAML::Emitter& out_;
};

template<class Struct>
void write(YAML::Emitter& out, const Struct& value) requires(std::is_class_v<Struct> && !Scalar<Struct>) {
  out << YAML::BeginMap;
  Writer writer(out);
  describe(writer, value);
  out << YAML::EndMap;
}

} // namespace

} // namespace config

std::string write_case(const Case& input) {
  YAML::Emitter out;
  config::write(out, input);
  return std::string(out.c_str()) + "\n";
}

} // namespace taut
