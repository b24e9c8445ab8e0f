#include "io/stl.hpp"

#include "io/text_scanner.hpp"
#include "partition/error.hpp"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cstring>
#include <map>

namespace taut {

namespace {

constexpr std::size_t header = 84, record = 50; // bytes: of the file, and of a triangle with its normal

class StlParser {
public:
  StlParser(std::string_view text, const std::string& name) : text_(text), name_(name) {}

  ObjFile parse() {
    is_binary() ? read_binary() : read_ascii();
    return std::move(file_);
  }

private:
  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(fmt::format("{}: {}; write the file again as STL", name_, what));
  }

  /// Some binary files begin with the word of ascii ones, but none of those has this length by accident.
  bool is_binary() const {
    if (text_.size() < header) return false;
    std::uint32_t triangles = 0;
    std::memcpy(&triangles, text_.data() + header - sizeof(triangles), sizeof(triangles));
    return text_.size() == header + record * std::size_t(triangles);
  }

  void read_binary() {
    for (std::size_t at = header; at < text_.size(); at += record) {
      std::array<float, 9> x;
      std::memcpy(x.data(), text_.data() + at + 3 * sizeof(float), sizeof(x));
      for (int k = 0; k < 3; ++k) add_corner(Vec3(x[3 * k], x[3 * k + 1], x[3 * k + 2]));
    }
  }

  void read_ascii() {
    TextScanner scanner(text_);
    bool found = false;
    while (scanner.next_line()) {
      const std::string_view word = scanner.next_word();
      found |= word == "solid";
      if (word != "vertex") continue;
      Vec3 x;
      for (double& number : x) {
        const std::string_view digits = scanner.next_word();
        const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
        if (error != std::errc{}) fail(fmt::format("line {}: '{}' is not a number", scanner.line(), digits));
      }
      add_corner(x);
    }
    if (!found || file_.cells.empty())
      fail("it is neither a binary STL file of the length it says, nor an ascii one with triangles");
    if (corners_ != 0) fail("a triangle lacks corners");
  }

  void add_corner(const Vec3& x) {
    if (!x.allFinite()) fail("a vertex is not finite");
    const auto [entry, is_new] = numbers_.try_emplace({x[0], x[1], x[2]}, Global(file_.positions.size()));
    if (is_new) {
      file_.positions.push_back(x);
      file_.vertex_lines.push_back(0);
    }
    cell_.vertices[corners_++] = entry->second;
    if (corners_ < 3) return;
    corners_ = 0;
    const auto& v = cell_.vertices;
    if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) return;
    file_.cells.push_back(cell_);
    file_.cell_lines.push_back(0);
  }

  std::string_view text_;
  const std::string& name_;
  std::map<std::array<double, 3>, Global> numbers_; ///< of vertices, by place
  Cell cell_;
  int corners_ = 0; ///< of `cell_` so far
  ObjFile file_;
};

} // namespace

ObjFile parse_stl(std::string_view text, const std::string& name) { return StlParser(text, name).parse(); }

} // namespace taut
