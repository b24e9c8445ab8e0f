// PLY and STL: the same square from every form of them, and what is said of broken ones.
#include "io/ply.hpp"
#include "io/stl.hpp"
#include "partition/error.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

using namespace taut;
using testing::HasSubstr;

namespace {

template<class T>
std::string bytes(std::initializer_list<T> values, bool swapped = false) {
  std::string all;
  for (const T value : values) {
    std::string one(sizeof(T), '\0');
    std::memcpy(one.data(), &value, sizeof(T));
    if (swapped) std::ranges::reverse(one);
    all += one;
  }
  return all;
}

std::string ply_header(const std::string& format, const std::string& type) {
  return "ply\nformat " + format + " 1.0\ncomment by hand\nelement vertex 4\nproperty " + type +
         " x\nproperty " + type + " y\nproperty " + type +
         " z\nproperty uchar red\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n";
}

std::string binary_ply(bool big) {
  std::string text = ply_header(big ? "binary_big_endian" : "binary_little_endian", "float");
  for (const auto& [x, y] : {std::pair{0.f, 0.f}, {1.f, 0.f}, {1.f, 1.f}, {0.f, 1.f}})
    text += bytes<float>({x, y, 2.f}, big) + bytes<std::uint8_t>({7});
  for (const auto& v : {std::array{0, 1, 2}, {0, 2, 3}})
    text += bytes<std::uint8_t>({3}) + bytes<std::int32_t>({v[0], v[1], v[2]}, big);
  return text;
}

const std::string ascii_ply =
    ply_header("ascii", "double") + "0 0 2 7\n1 0 2 7\n1 1 2 7\n0 1 2 7\n3 0 1 2\n3 0 2 3\n";

const std::string ascii_stl =
    "solid square\nfacet normal 0 0 1\nouter loop\nvertex 0 0 2\nvertex 1 0 2\nvertex 1 1 2\n"
    "endloop\nendfacet\nfacet normal 0 0 1\nouter loop\nvertex 0 0 2\nvertex 1 1 2\n"
    "vertex 0 1 2\nendloop\nendfacet\nendsolid\n";

/// With a third triangle that has no area.
std::string binary_stl() {
  std::string text = std::string("solid but binary") + std::string(64, ' ') + bytes<std::uint32_t>({3});
  for (const auto& t : {std::array{0.f, 0.f, 1.f, 0.f, 1.f, 1.f},
                        {0.f, 0.f, 1.f, 1.f, 0.f, 1.f},
                        {0.f, 0.f, 0.f, 0.f, 1.f, 1.f}})
    text += bytes<float>({0, 0, 1, t[0], t[1], 2, t[2], t[3], 2, t[4], t[5], 2}) + bytes<std::uint16_t>({0});
  return text;
}

void expect_square(const ObjFile& file) {
  ASSERT_EQ(file.positions.size(), 4u);
  ASSERT_EQ(file.cells.size(), 2u);
  EXPECT_EQ(file.positions[1], Vec3(1, 0, 2));
  EXPECT_EQ(file.positions[3], Vec3(0, 1, 2));
  EXPECT_EQ(file.cells[0].vertices, (std::array<Global, 4>{0, 1, 2, -1}));
  EXPECT_EQ(file.cells[1].vertices, (std::array<Global, 4>{0, 2, 3, -1}));
}

template<class Function>
std::string message_of(Function&& function) {
  try {
    function();
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

} // namespace

TEST(Ply, OfAnyEncodingGivesTheSame) {
  for (const std::string& text : {ascii_ply, binary_ply(false), binary_ply(true)})
    expect_square(parse_ply(text, "body.ply"));
}

TEST(Stl, OfAnyEncodingGivesTheSame) {
  for (const std::string& text : {ascii_stl, binary_stl()}) expect_square(parse_stl(text, "body.stl"));
}

TEST(Ply, BrokenIsRefused) {
  const auto of = [](const std::string& text) { return message_of([&] { parse_ply(text, "body.ply"); }); };
  EXPECT_THAT(of("off\n"), HasSubstr("body.ply: it does not begin with 'ply'"));
  EXPECT_THAT(of("ply\nformat ascii 1.0\n"), HasSubstr("no end_header"));
  EXPECT_THAT(of(binary_ply(false).substr(0, binary_ply(false).size() - 3)), HasSubstr("ends too early"));
  EXPECT_THAT(of(ply_header("ascii", "float") + "0 0 2 7\n1 0 x 7\n"), HasSubstr("'x' is not a number"));
  EXPECT_THAT(of("ply\nformat ascii 1.0\nelement vertex 99999999\nend_header\n"), HasSubstr("too short"));
  std::string text = ascii_ply;
  EXPECT_THAT(of(text.replace(text.rfind("0 2 3"), 5, "0 2 9")), HasSubstr("a face names vertex 9"));
  text = ascii_ply;
  EXPECT_THAT(of(text.replace(text.rfind("3 0 2 3"), 7, "5 0 2 3")), HasSubstr("has 5 corners"));
}

TEST(Stl, BrokenIsRefused) {
  const auto of = [](const std::string& text) { return message_of([&] { parse_stl(text, "body.stl"); }); };
  EXPECT_THAT(of("nothing"), HasSubstr("body.stl: it is neither a binary STL file"));
  EXPECT_THAT(of("solid a\nvertex 0 0 z\n"), HasSubstr("line 2: 'z' is not a number"));
  EXPECT_THAT(of(ascii_stl + "vertex 0 0 0\n"), HasSubstr("lacks corners"));
  EXPECT_THAT(of(binary_stl().substr(0, 120)), HasSubstr("neither a binary"));
}
