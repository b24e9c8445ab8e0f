#include "io/obj_parser.hpp"

#include "io/text_scanner.hpp"
#include "partition/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <span>
#include <system_error>

namespace taut {
namespace {

constexpr std::array<std::string_view, 6> without_use{"vn", "g", "o", "s", "usemtl", "mtllib"};

/// Editors put a byte order mark at the head of UTF-8, where it says nothing.
std::string_view without_mark(std::string_view text) {
  constexpr std::string_view mark = "\xEF\xBB\xBF";
  if (text.starts_with(mark)) text.remove_prefix(mark.size());
  return text;
}

class Parser {
public:
  Parser(std::string_view text, const std::string& name, Polygons polygons)
      : scanner_(without_mark(text)), name_(name), polygons_(polygons) {}

  ObjFile parse() {
    while (scanner_.next_line()) {
      const std::string_view keyword = scanner_.next_word();
      if (keyword.empty()) continue;
      if (keyword == "v")
        vertex();
      else if (keyword == "vt")
        texture_point();
      else if (keyword == "f")
        face();
      else if (keyword == "l")
        polyline();
      else if (std::ranges::find(without_use, keyword) == without_use.end())
        leave_out(keyword);
    }
    check_range();
    resolve_texture();
    return std::move(file_);
  }

private:
  [[noreturn]] void fail(Global line, const std::string& message) const {
    throw InputError(fmt::format("{}:{}: {}", name_, line, message));
  }
  [[noreturn]] void fail(const std::string& message) const { fail(scanner_.line(), message); }

  void leave_out(std::string_view keyword) {
    if (file_.unknown.lines++ > 0) return;
    file_.unknown.first_line = scanner_.line();
    file_.unknown.first_word = keyword.substr(0, 40);
  }

  void vertex() {
    Vec3 position;
    for (double& x : position)
      x = coordinate(scanner_.next_word()); // what may follow is a weight or a colour
    file_.positions.push_back(position);
    file_.vertex_lines.push_back(scanner_.line());
  }

  void texture_point() {
    Vec2 point;
    for (double& x : point) {
      const std::string_view word = scanner_.next_word();
      if (word.empty()) fail("texture coordinates need two numbers; write 'vt u v'");
      x = coordinate(word);
    }
    texture_points_.push_back(point);
  }

  double coordinate(std::string_view word) const {
    if (word.empty()) fail("a vertex needs three numbers; write 'v x y z'");
    double value = 0.0;
    const std::string_view digits = word.front() == '+' ? word.substr(1) : word;
    const auto [end, error] = std::from_chars(digits.begin(), digits.end(), value);
    if (error == std::errc::invalid_argument || end != digits.end())
      fail(fmt::format("'{}' is not a number; write 'v x y z' with numbers", word.substr(0, 40)));
    if (error == std::errc::result_out_of_range || !std::isfinite(value))
      fail(fmt::format("'{}' is not a finite number; give every vertex a finite place", word.substr(0, 40)));
    return value;
  }

  /// The vertex meant by a, a/b, a//c or a/b/c, counted from 0. Whether it exists may only show at the end.
  Global vertex_number(std::string_view word) const {
    Global number = 0;
    const auto [end, error] = std::from_chars(word.begin(), word.end(), number);
    if (error != std::errc() || (end != word.end() && *end != '/'))
      fail(fmt::format("'{}' is not a vertex number; write a, a/b, a//c or a/b/c", word.substr(0, 40)));
    if (number == 0) fail("there is no vertex 0; number the vertices from 1");
    if (number > 0) return number - 1;
    const Global before = static_cast<Global>(file_.positions.size());
    if (number < -before)
      fail(fmt::format("vertex {} does not exist, {} stand before this line; correct the number", number,
                       before));
    return before + number;
  }

  /// The texture point in a/b or a/b/c, counted from 0; -1 if there is none.
  Global texture_number(std::string_view word) const {
    const auto slash = word.find('/');
    if (slash == word.npos || slash + 1 == word.size() || word[slash + 1] == '/') return -1;
    Global number = 0;
    const auto [end, error] = std::from_chars(word.begin() + slash + 1, word.end(), number);
    if (error != std::errc() || (end != word.end() && *end != '/') || number == 0)
      fail(fmt::format("'{}' does not name texture coordinates; write a/b with numbers from 1",
                       word.substr(0, 40)));
    if (number > 0) return number - 1;
    const Global before = Global(texture_points_.size());
    if (number < -before)
      fail(fmt::format("texture coordinates {} do not exist, {} stand before this line; correct the number",
                       number, before));
    return before + number;
  }

  void add_cell(std::span<const Global> vertices, std::array<Global, 4> texture = {-1, -1, -1, -1}) {
    Cell cell;
    std::ranges::copy(vertices, cell.vertices.begin());
    for (std::size_t i = 0; i < vertices.size(); ++i)
      if (std::ranges::find(vertices.subspan(i + 1), vertices[i]) != vertices.end())
        fail(fmt::format("vertex {} is used twice; name each vertex of an element once", vertices[i] + 1));
    file_.cells.push_back(cell);
    texture_numbers_.push_back(texture);
    file_.cell_lines.push_back(scanner_.line());
  }

  void face() {
    std::vector<Global> vertices, texture;
    for (auto word = scanner_.next_word(); !word.empty(); word = scanner_.next_word()) {
      texture.push_back(texture_number(word));
      vertices.push_back(vertex_number(word));
    }
    const std::size_t count = vertices.size();
    if (count < 3) fail("a face has fewer than 3 vertices; give it 3 or 4, or write a line element 'l a b'");
    if (count > 4 && polygons_ == Polygons::refuse)
      fail("a face has more than 4 vertices; split it into quads and triangles");
    if (count == 4) return add_cell(vertices, {texture[0], texture[1], texture[2], texture[3]});
    for (std::size_t k = 2; k < count; ++k)
      add_cell(std::array{vertices[0], vertices[k - 1], vertices[k]},
               {texture[0], texture[k - 1], texture[k], -1});
  }

  void polyline() {
    std::optional<Global> previous;
    Global segments = 0;
    for (auto word = scanner_.next_word(); !word.empty(); word = scanner_.next_word()) {
      const Global vertex = vertex_number(word);
      if (previous) add_cell(std::array{*previous, vertex}), ++segments;
      previous = vertex;
    }
    if (segments == 0) fail("a line element has fewer than 2 vertices; write 'l a b'");
  }

  void check_range() const {
    const Global count = static_cast<Global>(file_.positions.size());
    for (std::size_t c = 0; c < file_.cells.size(); ++c) {
      const Global largest = std::ranges::max(file_.cells[c].vertices);
      if (largest >= count)
        fail(file_.cell_lines[c], fmt::format("vertex {} does not exist, the file has {}; correct the number",
                                              largest + 1, count));
    }
  }

  void check_texture_range() const {
    const auto count = Global(texture_points_.size());
    for (std::size_t c = 0; c < texture_numbers_.size(); ++c)
      if (const Global largest = std::ranges::max(texture_numbers_[c]); largest >= count)
        fail(file_.cell_lines[c],
             fmt::format("texture coordinates {} do not exist, the file has {}; correct the number",
                         largest + 1, count));
  }

  /// Once all points are known.
  void resolve_texture() {
    const auto named = [](const std::array<Global, 4>& numbers) { return numbers[0] >= 0; };
    check_texture_range();
    if (std::ranges::none_of(texture_numbers_, named)) return;
    for (std::size_t c = 0; c < file_.cells.size(); ++c) file_.texture.push_back(texture_of(c));
  }

  /// Zero for a cell of which a corner has none.
  Corners2 texture_of(std::size_t cell) const {
    Corners2 corners{Vec2::Zero(), Vec2::Zero(), Vec2::Zero(), Vec2::Zero()};
    const auto numbers = std::span(texture_numbers_[cell]).first(std::size_t(file_.cells[cell].size()));
    if (std::ranges::min(numbers) < 0) return corners;
    for (std::size_t k = 0; k < numbers.size(); ++k) corners[k] = texture_points_[numbers[k]];
    return corners;
  }

  TextScanner scanner_;
  const std::string& name_;
  Polygons polygons_;
  ObjFile file_;
  std::vector<Vec2> texture_points_;
  std::vector<std::array<Global, 4>> texture_numbers_; ///< of the corners of each cell, -1 for none
};

} // namespace

ObjFile parse_obj(std::string_view text, const std::string& name, Polygons polygons) {
  return Parser(text, name, polygons).parse();
}

Unused drop_unused(ObjFile& file) {
  Unused unused;
  if (file.cells.empty()) return unused;
  constexpr Global none = -1;
  std::vector<Global> number(file.positions.size(), none);
  for (const Cell& cell : file.cells)
    for (int k = 0; k < cell.size(); ++k) number[cell.vertices[k]] = 0;
  Global kept = 0;
  for (std::size_t v = 0; v < number.size(); ++v) {
    const Global line = file.vertex_lines.empty() ? 0 : file.vertex_lines[v];
    if (number[v] == none) {
      if (unused.vertices++ == 0) unused.first_line = line;
      continue;
    }
    number[v] = kept;
    file.positions[kept] = file.positions[v];
    if (!file.vertex_lines.empty()) file.vertex_lines[kept] = line;
    ++kept;
  }
  file.positions.resize(kept);
  if (!file.vertex_lines.empty()) file.vertex_lines.resize(kept);
  for (Cell& cell : file.cells)
    for (int k = 0, corners = cell.size(); k < corners; ++k) cell.vertices[k] = number[cell.vertices[k]];
  return unused;
}

} // namespace taut
