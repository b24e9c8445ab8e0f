#include "io/ply.hpp"

#include "partition/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>

namespace taut {

namespace {

enum class Number { int8, uint8, int16, uint16, int32, uint32, float32, float64 };
enum class Encoding { ascii, little, big };

struct TypeName {
  std::string_view name;
  Number type;
};
constexpr std::array types{TypeName{"char", Number::int8},      TypeName{"int8", Number::int8},
                           TypeName{"uchar", Number::uint8},    TypeName{"uint8", Number::uint8},
                           TypeName{"short", Number::int16},    TypeName{"int16", Number::int16},
                           TypeName{"ushort", Number::uint16},  TypeName{"uint16", Number::uint16},
                           TypeName{"int", Number::int32},      TypeName{"int32", Number::int32},
                           TypeName{"uint", Number::uint32},    TypeName{"uint32", Number::uint32},
                           TypeName{"float", Number::float32},  TypeName{"float32", Number::float32},
                           TypeName{"double", Number::float64}, TypeName{"float64", Number::float64}};

struct Property {
  std::string_view name;
  std::optional<Number> length; ///< of a list: the type of its length
  Number type = Number::float32;
};

struct PlyElement {
  std::string_view name;
  Global count = 0;
  std::vector<Property> properties{};
};

std::string_view next_word(std::string_view& text) {
  const auto begin = std::min(text.find_first_not_of(" \t\r\n"), text.size());
  const auto end = std::min(text.find_first_of(" \t\r\n", begin), text.size());
  const std::string_view word = text.substr(begin, end - begin);
  text.remove_prefix(end);
  return word;
}

class PlyParser {
public:
  PlyParser(std::string_view text, const std::string& name) : rest_(text), name_(name) {}

  ObjFile parse() {
    read_header();
    for (const PlyElement& element : elements_)
      for (Global i = 0; i < element.count; ++i) read_entry(element);
    const Global vertices = Global(file_.positions.size());
    for (const Cell& cell : file_.cells)
      for (int k = 0; k < cell.size(); ++k)
        if (cell.vertices[k] < 0 || cell.vertices[k] >= vertices)
          fail(fmt::format("a face names vertex {}, but there are {}, counted from 0", cell.vertices[k],
                           vertices));
    return std::move(file_);
  }

private:
  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(fmt::format("{}: {}; write the file again as PLY with triangles or quads", name_, what));
  }

  Number type_called(std::string_view word) const {
    const auto found =
        std::find_if(types.begin(), types.end(), [&](const TypeName& t) { return t.name == word; });
    if (found == types.end()) fail(fmt::format("'{}' is not a type of PLY", word));
    return found->type;
  }

  void read_header() {
    if (next_word(rest_) != "ply") fail("it does not begin with 'ply'");
    for (;;) {
      const auto end = rest_.find('\n');
      if (end == std::string_view::npos) fail("its header has no end_header");
      std::string_view line = rest_.substr(0, end);
      rest_.remove_prefix(end + 1);
      const std::string_view word = next_word(line);
      if (word == "end_header") return;
      if (word == "format") encoding_ = encoding_called(next_word(line));
      if (word == "element") add_element(line);
      if (word == "property") add_property(line);
    }
  }

  Encoding encoding_called(std::string_view word) const {
    if (word == "ascii") return Encoding::ascii;
    if (word == "binary_little_endian") return Encoding::little;
    if (word == "binary_big_endian") return Encoding::big;
    fail(fmt::format("'{}' is not a format of PLY", word));
  }

  void add_element(std::string_view line) {
    PlyElement element{next_word(line)};
    const std::string_view count = next_word(line);
    const auto [end, error] = std::from_chars(count.data(), count.data() + count.size(), element.count);
    if (error != std::errc{} || element.count < 0)
      fail(fmt::format("'{}' is not a number of elements", count));
    if (element.count > Global(rest_.size())) fail(fmt::format("it is too short for {} elements", count));
    elements_.push_back(std::move(element));
  }

  void add_property(std::string_view line) {
    if (elements_.empty()) fail("a property stands before any element");
    std::string_view word = next_word(line);
    Property property;
    if (word == "list") {
      property.length = type_called(next_word(line));
      word = next_word(line);
    }
    property.type = type_called(word);
    property.name = next_word(line);
    elements_.back().properties.push_back(property);
  }

  void read_entry(const PlyElement& element) {
    Vec3 position = Vec3::Zero();
    for (const Property& p : element.properties) {
      if (p.length) {
        read_list(element, p);
        continue;
      }
      const double value = read_number(p.type);
      for (int k = 0; k < 3; ++k)
        if (p.name == std::string_view("xyz").substr(std::size_t(k), 1)) position[k] = value;
    }
    if (element.name != "vertex") return;
    if (!position.allFinite()) fail(fmt::format("vertex {} is not finite", file_.positions.size()));
    file_.positions.push_back(position);
    file_.vertex_lines.push_back(0);
  }

  void read_list(const PlyElement& element, const Property& p) {
    const double length = read_number(*p.length);
    if (!(length >= 0) || length > double(rest_.size())) fail("a list has no sound length");
    const bool is_face = element.name == "face" && (p.name == "vertex_indices" || p.name == "vertex_index");
    if (is_face && length != 3 && length != 4)
      fail(fmt::format("face {} has {} corners instead of 3 or 4", file_.cells.size(), length));
    Cell cell;
    for (int k = 0; k < int(length); ++k) {
      const double value = read_number(p.type);
      if (is_face) cell.vertices[k] = std::abs(value) < 1e15 ? Global(value) : -1;
    }
    if (!is_face) return;
    file_.cells.push_back(cell);
    file_.cell_lines.push_back(0);
  }

  double read_number(Number type) {
    if (encoding_ == Encoding::ascii) {
      const std::string_view word = next_word(rest_);
      double value = 0;
      const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
      if (error != std::errc{} || end != word.data() + word.size())
        fail(word.empty() ? std::string("it ends too early") : fmt::format("'{}' is not a number", word));
      return value;
    }
    switch (type) {
    case Number::int8:
      return take<std::int8_t>();
    case Number::uint8:
      return take<std::uint8_t>();
    case Number::int16:
      return take<std::int16_t>();
    case Number::uint16:
      return take<std::uint16_t>();
    case Number::int32:
      return take<std::int32_t>();
    case Number::uint32:
      return take<std::uint32_t>();
    case Number::float32:
      return take<float>();
    case Number::float64:
      return take<double>();
    }
    return 0;
  }

  template<class T>
  double take() {
    if (rest_.size() < sizeof(T)) fail("it ends too early");
    std::array<char, sizeof(T)> bytes;
    std::copy_n(rest_.begin(), sizeof(T), bytes.begin());
    rest_.remove_prefix(sizeof(T));
    if ((encoding_ == Encoding::big) != (std::endian::native == std::endian::big))
      std::reverse(bytes.begin(), bytes.end());
    T value;
    std::memcpy(&value, bytes.data(), sizeof(T));
    return double(value);
  }

  std::string_view rest_;
  const std::string& name_;
  Encoding encoding_ = Encoding::ascii;
  std::vector<PlyElement> elements_;
  ObjFile file_;
};

} // namespace

ObjFile parse_ply(std::string_view text, const std::string& name) { return PlyParser(text, name).parse(); }

} // namespace taut
