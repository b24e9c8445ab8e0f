#include "src/output/surface_text.hpp"

#include <bit>
#include <cstdint>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <iterator>

namespace taut {

namespace {

std::size_t faces(const Surface& s) { return s.offsets.size() - 1; }

template<class T>
void append_bytes(std::string& text, T value) {
  static_assert(std::endian::native == std::endian::little);
  text.append(reinterpret_cast<const char*>(&value), sizeof(T));
}

std::string tuples(const std::vector<double>& numbers) {
  fmt::memory_buffer text;
  for (std::size_t i = 0; i + 1 < numbers.size(); i += 2)
    fmt::format_to(std::back_inserter(text), "{}({:.9g}, {:.9g})", i ? ", " : "", numbers[i], numbers[i + 1]);
  return {text.data(), text.size()};
}

} // namespace

std::string obj_text(const Surface& s) {
  fmt::memory_buffer text;
  const auto out = std::back_inserter(text);
  for (const Vec3& p : s.positions) fmt::format_to(out, "v {:.9g} {:.9g} {:.9g}\n", p[0], p[1], p[2]);
  for (std::size_t i = 0; i + 1 < s.texture.size(); i += 2)
    fmt::format_to(out, "vt {:.9g} {:.9g}\n", s.texture[i], s.texture[i + 1]);
  for (std::size_t f = 0; f < faces(s); ++f) {
    text.push_back(s.offsets[f + 1] - s.offsets[f] == 2 ? 'l' : 'f');
    for (Global c = s.offsets[f]; c < s.offsets[f + 1]; ++c)
      s.texture.empty() ? fmt::format_to(out, " {}", s.corners[c] + 1)
                        : fmt::format_to(out, " {}/{}", s.corners[c] + 1, c + 1);
    text.push_back('\n');
  }
  return {text.data(), text.size()};
}

std::string ply_text(const Surface& s) {
  std::string text = fmt::format("ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\n"
                                 "property float y\nproperty float z\nelement face {}\n"
                                 "property list uchar int vertex_indices\nend_header\n",
                                 s.positions.size(), faces(s));
  for (const Vec3& p : s.positions)
    for (const double x : p) append_bytes(text, float(x));
  for (std::size_t f = 0; f < faces(s); ++f) {
    append_bytes(text, std::uint8_t(s.offsets[f + 1] - s.offsets[f]));
    for (Global c = s.offsets[f]; c < s.offsets[f + 1]; ++c) append_bytes(text, std::int32_t(s.corners[c]));
  }
  return text;
}

std::string usda_text(const Surface& s) {
  std::vector<Global> sizes;
  for (std::size_t f = 0; f < faces(s); ++f) sizes.push_back(s.offsets[f + 1] - s.offsets[f]);
  fmt::memory_buffer points;
  for (std::size_t i = 0; i < s.positions.size(); ++i)
    fmt::format_to(std::back_inserter(points), "{}({:.9g}, {:.9g}, {:.9g})", i ? ", " : "", s.positions[i][0],
                   s.positions[i][1], s.positions[i][2]);
  const std::string texture =
      s.texture.empty()
          ? ""
          : fmt::format(
                "    texCoord2f[] primvars:st = [{}] (\n        interpolation = \"faceVarying\"\n    )\n",
                tuples(s.texture));
  return fmt::format(
      "#usda 1.0\n(\n    defaultPrim = \"cloth\"\n    metersPerUnit = {:.9g}\n    upAxis = \"{}\"\n)\n\n"
      "def Mesh \"cloth\"\n{{\n    uniform token subdivisionScheme = \"none\"\n"
      "    int[] faceVertexCounts = [{}]\n    int[] faceVertexIndices = [{}]\n"
      "    point3f[] points = [{}]\n{}}}\n",
      s.metres_per_unit, s.up == 'y' ? "Y" : "Z", fmt::join(sizes, ", "), fmt::join(s.corners, ", "),
      std::string_view(points.data(), points.size()), texture);
}

} // namespace taut
