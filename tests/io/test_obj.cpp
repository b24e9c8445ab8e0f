#include "io/hdf5.hpp"
#include "io/mesh_file.hpp"
#include "io/obj.hpp"
#include "io/obj_parser.hpp"
#include "io/whole_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdlib>

using namespace taut;
using testing::AllOf;
using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

namespace {

namespace fs = std::filesystem;
const MPI_Comm world = MPI_COMM_WORLD;

const std::string square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"; // four vertices on lines 1 to 4

/// A file with `text`, gone at the end.
class TemporaryFile {
public:
  explicit TemporaryFile(const std::string& text, const std::string& name = "file.obj") : name_(name) {
    folder_ = broadcast(world, [] {
      std::string folder = (fs::temp_directory_path() / "taut-obj-XXXXXX").string();
      return std::string(mkdtemp(folder.data()));
    });
    write_text_whole(world, path(), text);
  }
  ~TemporaryFile() {
    MPI_Barrier(world);
    if (rank_of(world) == 0) fs::remove_all(folder_);
  }
  fs::path path() const { return folder_ / name_; }

private:
  std::string name_;
  fs::path folder_;
};

template<class Function>
std::string message_of(Function&& function) {
  try {
    function();
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

std::string parse_error(const std::string& text) {
  return message_of([&] { parse_obj(text, "file.obj"); });
}

std::vector<std::array<Global, 4>> cells_of(const std::string& text) {
  std::vector<std::array<Global, 4>> cells;
  for (const Cell& cell : parse_obj(text, "file.obj").cells) cells.push_back(cell.vertices);
  return cells;
}

using Vertices = std::array<Global, 4>;

/// A grid of side x side quads, with a comment in front.
std::string grid_text(int side) {
  std::string text = "# grid\n";
  for (int j = 0; j <= side; ++j)
    for (int i = 0; i <= side; ++i) text += "v " + std::to_string(i) + " " + std::to_string(j) + " 0.5\n";
  for (int j = 0; j < side; ++j)
    for (int i = 0; i < side; ++i) {
      const int a = j * (side + 1) + i + 1, b = a + side + 1;
      text += "f " + std::to_string(a) + " " + std::to_string(a + 1) + " " + std::to_string(b + 1) + " " +
              std::to_string(b) + "\n";
    }
  return text;
}

void write_mesh(const fs::path& path, const std::vector<Vec3>& points, const std::vector<Global>& faces,
                const std::vector<Global>& offsets) {
  const auto whole = [](const auto& list) {
    const Global total = Global(list.size());
    return rank_of(world) == 0 ? Slab{0, total, total} : Slab{total, 0, total};
  };
  const bool root = rank_of(world) == 0;
  write_whole(world, path, [&](H5Writer& file) {
    file.write("/rest_positions", std::span(points).first(root ? points.size() : 0), whole(points));
    file.write<Global>("/faces", std::span(faces).first(root ? faces.size() : 0), 1, whole(faces));
    file.write<Global>("/face_offsets", std::span(offsets).first(root ? offsets.size() : 0), 1,
                       whole(offsets));
  });
}

const std::vector<Vec3> five_points{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {2, 0, 0}};

} // namespace

TEST(ObjParser, ReadsVerticesAndTheirLines) {
  const ObjFile file =
      parse_obj("# a comment\n\nv 1 -2.5e-1 +3\n  v\t4 5 6 # behind\nv 7 8 9 1.0\n", "file.obj");
  EXPECT_THAT(file.positions, ElementsAre(Vec3(1, -0.25, 3), Vec3(4, 5, 6), Vec3(7, 8, 9)));
  EXPECT_THAT(file.vertex_lines, ElementsAre(3, 4, 5));
}

TEST(ObjParser, ReadsFacesInAllForms) {
  const Vertices quad{0, 1, 2, 3}, triangle{0, 1, 2, -1};
  EXPECT_THAT(cells_of(square + "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n" +
                       "f 1 2 3 4\nf 1/1 2/2 3/3 4/4\nf 1//1 2//1 3//1 4//1\nf 1/2/3 2/2/3 3/2/3 4/2/3\n"),
              ElementsAre(quad, quad, quad, quad));
  EXPECT_THAT(cells_of(square + "f 1 2 3\nf -4 -3 -2\nf -4//-1 -3//-1 -2//-1"),
              ElementsAre(triangle, triangle, triangle));
  EXPECT_THAT(parse_obj(square + "f 1 2 3\n\nf 1 2 3 4\n", "file.obj").cell_lines, ElementsAre(5, 7));
}

TEST(ObjParser, RelativeNumbersCountFromWhereTheyStand) {
  EXPECT_THAT(cells_of("v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 5 5 5\nf -3 -2 -1\n"),
              ElementsAre(Vertices{0, 1, 2, -1}, Vertices{1, 2, 3, -1}));
}

TEST(ObjParser, AllowsVerticesThatFollowTheirFace) {
  EXPECT_THAT(cells_of("f 1 2 3 4\n" + square), ElementsAre(Vertices{0, 1, 2, 3}));
}

TEST(ObjParser, ReadsTextureCoordinatesOfCorners) {
  const std::string points = "vt 0 0\nvt 2 0\nvt 0 3\n";
  const ObjFile file = parse_obj(square + points + "f 1/1 2/2 4/3\nf 2/-1/1 3/1 4/2\nl 1 2\n", "file.obj");
  ASSERT_EQ(file.texture.size(), 3u);
  EXPECT_EQ(file.texture[0], (Corners2{Vec2(0, 0), Vec2(2, 0), Vec2(0, 3), Vec2(0, 0)}));
  EXPECT_EQ(file.texture[1], (Corners2{Vec2(0, 3), Vec2(0, 0), Vec2(2, 0), Vec2(0, 0)}));
  EXPECT_TRUE(parse_obj(square + points + "f 1 2 3\n", "file.obj").texture.empty());
}

TEST(ObjParser, AllowsFacesWithoutTextureCoordinates) {
  const ObjFile file = parse_obj(square + "vt 1 2\nf 1/1 2/1 3/1\nf 1 2 3\nf 1/1 2 3\n", "file.obj");
  EXPECT_EQ(file.texture[0][2], Vec2(1, 2));
  for (const int untextured : {1, 2}) {
    for (const Vec2& corner : file.texture[untextured]) EXPECT_EQ(corner, Vec2(0, 0));
  }
}

TEST(ObjParser, RefusesTextureCoordinatesThatAreNotThere) {
  EXPECT_EQ(parse_error(square + "vt 0 0\nf 1/1 2/2 3/1\n"),
            "file.obj:6: texture coordinates 2 do not exist, the file has 1; correct the number");
  EXPECT_EQ(parse_error(square + "f 1/1 2/2 3/3\n"),
            "file.obj:5: texture coordinates 3 do not exist, the file has 0; correct the number");
  EXPECT_EQ(parse_error(square + "vt 0 0\nf 1/7 2 3\n"),
            "file.obj:6: texture coordinates 7 do not exist, the file has 1; correct the number");
  EXPECT_EQ(parse_error(square + "vt 0 0\nf 1/-2 2/1 3/1\n"),
            "file.obj:6: texture coordinates -2 do not exist, 1 stand before this line; correct the number");
  EXPECT_EQ(parse_error(square + "vt 0\n"),
            "file.obj:5: texture coordinates need two numbers; write 'vt u v'");
}

TEST(ObjParser, CutsPolylinesIntoSegments) {
  const std::string text = square + "l 1 2/1 -2\n";
  EXPECT_THAT(cells_of(text), ElementsAre(Vertices{0, 1, -1, -1}, Vertices{1, 2, -1, -1}));
  EXPECT_THAT(parse_obj(text, "file.obj").cell_lines, ElementsAre(5, 5));
}

TEST(ObjParser, JoinsContinuedLines) {
  const ObjFile file = parse_obj(square + "f 1 2 \\\n 3\\\n 4\ng one \\\n two\nf 1 2 3\n", "file.obj");
  EXPECT_EQ(file.cells[0].vertices, (Vertices{0, 1, 2, 3}));
  EXPECT_THAT(file.cell_lines, ElementsAre(5, 10));
}

TEST(ObjParser, ReadsWindowsLineEnds) {
  const ObjFile file =
      parse_obj("# dos\r\nv 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\n\r\nf 1 2 \\\r\n3\r\n", "file.obj");
  EXPECT_THAT(file.vertex_lines, ElementsAre(2, 3, 4));
  EXPECT_THAT(file.cell_lines, ElementsAre(6));
}

TEST(ObjParser, PassesOverAByteOrderMark) {
  const ObjFile file = parse_obj("\xEF\xBB\xBF" + square + "f 1 2 3\n", "file.obj");
  EXPECT_EQ(file.positions.size(), 4u);
  EXPECT_THAT(file.vertex_lines, ElementsAre(1, 2, 3, 4));
}

TEST(ObjParser, LeavesOutWhatIsNoShape) {
  EXPECT_THAT(
      cells_of("mtllib a.mtl\no cloth\ng part\ns off\nusemtl red\nvt 0 0\nvn 0 0 1\n" + square + "f 1 2 3"),
      ElementsAre(Vertices{0, 1, 2, -1}));
  EXPECT_THAT(cells_of(""), IsEmpty());
}

TEST(ObjParser, NamesTheLineOfWhatIsNoNumber) {
  EXPECT_THAT(parse_error("v 0 0 0\nv 1 x 0\n"), StartsWith("file.obj:2: 'x' is not a number; "));
  EXPECT_THAT(parse_error("v 0 0 1.5m\n"), StartsWith("file.obj:1: '1.5m' is not a number; "));
  EXPECT_THAT(parse_error("v 0 0\n"), StartsWith("file.obj:1: a vertex needs three numbers; "));
  EXPECT_THAT(parse_error(square + "f 1 2 three\n"),
              StartsWith("file.obj:5: 'three' is not a vertex number; "));
  EXPECT_THAT(parse_error(square + "f 1 2 3.5\n"), StartsWith("file.obj:5: '3.5' is not a vertex number; "));
}

TEST(ObjParser, CountsLinesThatItDoesNotKnow) {
  const ObjFile file =
      parse_obj("# by an exporter\n" + square + "vv 1 2\ng body\nvp 0.5\nf 1 2 3 4\n", "file.obj");
  EXPECT_EQ(file.cells.size(), 1);
  EXPECT_EQ(file.unknown.lines, 2);
  EXPECT_EQ(file.unknown.first_line, 6);
  EXPECT_EQ(file.unknown.first_word, "vv");
  EXPECT_EQ(parse_obj(square + "f 1 2 3 4\n", "file.obj").unknown.lines, 0);
}

TEST(ObjParser, CutsPolygonsIntoTriangles) {
  const ObjFile file = parse_obj(square + "v -1 0.5 0\nvt 1 2\nf 1 2 3 4 5\nf 1/1 2/1 3/1 4/1\n", "file.obj",
                                 Polygons::triangulate);
  const std::vector<std::array<Global, 4>> expected{
      {0, 1, 2, -1}, {0, 2, 3, -1}, {0, 3, 4, -1}, {0, 1, 2, 3}};
  ASSERT_EQ(file.cells.size(), expected.size());
  for (std::size_t c = 0; c < expected.size(); ++c) EXPECT_EQ(file.cells[c].vertices, expected[c]);
  EXPECT_THAT(file.cell_lines, ElementsAre(7, 7, 7, 8));
  EXPECT_THAT(parse_error(square + "f 1 2 3 4 4\n"), HasSubstr("more than 4 vertices"));
}

TEST(ObjParser, DropsVerticesThatNoCellHas) {
  ObjFile file = parse_obj("v 9 9 9\nv 0 0 0\nv 8 8 8\nv 1 0 0\nv 0 1 0\nf 2 4 5\nl 5 2\n", "file.obj");
  const Unused unused = drop_unused(file);
  EXPECT_EQ(unused.vertices, 2);
  EXPECT_EQ(unused.first_line, 1);
  EXPECT_EQ(file.positions, (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
  EXPECT_THAT(file.vertex_lines, ElementsAre(2, 4, 5));
  EXPECT_EQ(file.cells[0].vertices, (std::array<Global, 4>{0, 1, 2, -1}));
  EXPECT_EQ(file.cells[1].vertices, (std::array<Global, 4>{2, 0, -1, -1}));
  ObjFile points = parse_obj(square, "file.obj");
  EXPECT_EQ(drop_unused(points).vertices, 0); // a start shape may hold places alone
  EXPECT_EQ(points.positions.size(), 4);
}

TEST(ObjParser, RefusesWhatIsNotFinite) {
  for (const std::string word : {"nan", "NaN", "inf", "-inf", "1e999"})
    EXPECT_THAT(parse_error("v 0 0 0\nv 0 " + word + " 0\n"),
                StartsWith("file.obj:2: '" + word + "' is not a finite number; "));
}

TEST(ObjParser, RefusesVerticesThatDoNotExist) {
  EXPECT_THAT(parse_error(square + "f 0 1 2\n"), StartsWith("file.obj:5: there is no vertex 0; "));
  EXPECT_THAT(parse_error(square + "f 1 2 3\nf 1 2 5\n"),
              StartsWith("file.obj:6: vertex 5 does not exist, the file has 4; "));
  EXPECT_THAT(parse_error(square + "f 1 2 -5\n"),
              StartsWith("file.obj:5: vertex -5 does not exist, 4 stand before"));
}

TEST(ObjParser, RefusesFacesOfTheWrongSize) {
  EXPECT_THAT(
      parse_error(square + "v 2 2 2\nf 1 2 3 4 5\n"),
      AllOf(StartsWith("file.obj:6: a face has more than 4 vertices; "), HasSubstr("split it into quads")));
  EXPECT_THAT(parse_error(square + "f 1 2\n"), StartsWith("file.obj:5: a face has fewer than 3 vertices; "));
  EXPECT_THAT(parse_error(square + "f\n"), StartsWith("file.obj:5: a face has fewer than 3 vertices; "));
  EXPECT_THAT(parse_error(square + "l 1\n"),
              StartsWith("file.obj:5: a line element has fewer than 2 vertices; "));
}

TEST(ObjParser, RefusesARepeatedVertex) {
  EXPECT_THAT(parse_error(square + "f 1 2 1\n"), StartsWith("file.obj:5: vertex 1 is used twice; "));
  EXPECT_THAT(parse_error(square + "f 1 2 3 -3\n"), StartsWith("file.obj:5: vertex 2 is used twice; "));
  EXPECT_THAT(parse_error(square + "l 1 2 2\n"), StartsWith("file.obj:5: vertex 2 is used twice; "));
}

TEST(Obj, RefusesAMissingFile) {
  EXPECT_THAT(message_of([] { read_obj(world, "/none/file.obj", 1.0); }),
              StartsWith("/none/file.obj: no such file, or it may not be read; "));
  EXPECT_THAT(message_of([] { read_obj(world, "/", 1.0); }), HasSubstr("no such file"));
}

TEST(Obj, RefusesAMeshWithNothingInIt) {
  const TemporaryFile empty(""), points("v 0 0 0\n"), faces("f 1 2 3\n");
  EXPECT_THAT(message_of([&] { read_obj(world, empty.path(), 1.0); }), HasSubstr("file.obj: no vertices; "));
  EXPECT_THAT(message_of([&] { read_obj(world, points.path(), 1.0); }),
              HasSubstr("file.obj: no faces or lines; "));
  EXPECT_THAT(message_of([&] { read_obj(world, faces.path(), 1.0); }),
              HasSubstr("file.obj:1: vertex 3 does not exist"));
}

TEST(Obj, TellsAllRanksTheError) {
  const TemporaryFile file(square + "f 1 2 9\n");
  EXPECT_EQ(message_of([&] { read_obj(world, file.path(), 1.0); }),
            file.path().string() + ":5: vertex 9 does not exist, the file has 4; correct the number");
}

TEST(Obj, GivesTheSameSlabsAtAnyRankCount) {
  const int side = 7;
  const TemporaryFile file(grid_text(side));
  const MeshSlab mesh = read_mesh(world, file.path(), 0.1);
  const ObjFile whole = parse_obj(grid_text(side), "file.obj");
  EXPECT_THAT(mesh.name, EndsWith("file.obj"));
  EXPECT_EQ(mesh.vertices.total, (side + 1) * (side + 1));
  EXPECT_EQ(mesh.cells.total, side * side);
  EXPECT_EQ(mesh.vertices.first, slab_of(mesh.vertices.total, size_of(world), rank_of(world)).first);
  ASSERT_EQ(Global(mesh.rest_positions.size()), mesh.vertices.count);
  ASSERT_EQ(Global(mesh.cell.size()), mesh.cells.count);
  for (Global v = 0; v < mesh.vertices.count; ++v) {
    EXPECT_EQ(mesh.rest_positions[v], whole.positions[mesh.vertices.first + v] * 0.1);
    EXPECT_EQ(mesh.vertex_lines[v], mesh.vertices.first + v + 2);
  }
  for (Global c = 0; c < mesh.cells.count; ++c) {
    EXPECT_EQ(mesh.cell[c].vertices, whole.cells[mesh.cells.first + c].vertices);
    EXPECT_EQ(mesh.cell_lines[c], mesh.vertices.total + mesh.cells.first + c + 2);
  }
  EXPECT_EQ(sum_over(world, mesh.vertices.count), mesh.vertices.total);
  EXPECT_EQ(sum_over(world, mesh.cells.count), mesh.cells.total);
}

TEST(Obj, AllowsFewerCellsThanRanks) {
  const TemporaryFile file("v 0 0 0\nv 1 0 0\nl 1 2\n");
  const MeshSlab mesh = read_obj(world, file.path(), 1.0);
  EXPECT_EQ(sum_over(world, Global(mesh.rest_positions.size())), 2);
  EXPECT_EQ(sum_over(world, Global(mesh.cell.size())), 1);
}

TEST(Obj, ReadsOnlyPositionsForAStart) {
  const TemporaryFile file(square);
  const Slab mine = slab_of(4, size_of(world), rank_of(world));
  const std::vector<Vec3> expected{{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}};
  const auto positions = read_obj_positions(world, file.path(), 2.0, mine);
  ASSERT_EQ(Global(positions.size()), mine.count);
  for (Global v = 0; v < mine.count; ++v) EXPECT_EQ(positions[v], expected[mine.first + v]);
  const Slab other = slab_of(5, size_of(world), rank_of(world));
  EXPECT_THAT(message_of([&] { read_obj_positions(world, file.path(), 1.0, other); }),
              HasSubstr("file.obj: it has 4 vertices, the mesh 5; "));
}

TEST(MeshFile, ReadsMixedCellsFromHdf5) {
  const TemporaryFile file("", "m.h5");
  write_mesh(file.path(), five_points, {0, 1, 2, 3, 1, 4, 2, 0, 4}, {0, 4, 7, 9});
  const MeshSlab mesh = read_mesh(world, file.path(), 2.0);
  EXPECT_EQ(mesh.vertices.total, 5);
  EXPECT_EQ(mesh.cells.total, 3);
  const std::vector<Cell> expected{{{0, 1, 2, 3}}, {{1, 4, 2, -1}}, {{0, 4, -1, -1}}};
  ASSERT_EQ(Global(mesh.cell.size()), mesh.cells.count);
  for (Global c = 0; c < mesh.cells.count; ++c)
    EXPECT_EQ(mesh.cell[c].vertices, expected[mesh.cells.first + c].vertices);
  ASSERT_EQ(Global(mesh.rest_positions.size()), mesh.vertices.count);
  for (Global v = 0; v < mesh.vertices.count; ++v)
    EXPECT_EQ(mesh.rest_positions[v], 2.0 * five_points[mesh.vertices.first + v]);
}

TEST(MeshFile, NamesFileAndDatasetInErrors) {
  const TemporaryFile file("", "m.h5");
  const auto message = [&](const std::vector<Vec3>& points, const std::vector<Global>& faces,
                           const std::vector<Global>& offsets) {
    write_mesh(file.path(), points, faces, offsets);
    return message_of([&] { read_mesh(world, file.path(), 1.0); });
  };
  const double nan = std::nan("");
  EXPECT_THAT(message({}, {}, {0}), HasSubstr("m.h5: /rest_positions: no vertices"));
  EXPECT_THAT(message({{0, 0, 0}, {0, nan, 0}}, {0, 1}, {0, 2}), HasSubstr("vertex 1 is not finite"));
  EXPECT_THAT(message(five_points, {}, {0}), HasSubstr("/face_offsets: no faces"));
  EXPECT_THAT(message(five_points, {0, 1, 2}, {1, 3}), HasSubstr("/face_offsets: it does not begin with 0"));
  EXPECT_THAT(message(five_points, {0, 1, 2}, {0, 2}), HasSubstr("it ends with 2, but /faces has 3 numbers"));
  EXPECT_THAT(message(five_points, {0, 1, 2, 3, 4}, {0, 5}), HasSubstr("cell 0 has 5 vertices"));
  EXPECT_THAT(message(five_points, {0, 1, 2, 1, 5, 3}, {0, 3, 6}), HasSubstr("cell 1 names vertex 5, but"));
  EXPECT_THAT(message(five_points, {0, -1, 2}, {0, 3}), HasSubstr("/faces: cell 0 names vertex -1"));
  EXPECT_THAT(message(five_points, {0, 1, 0}, {0, 3}), HasSubstr("names vertex 0 twice"));
  write_whole(world, file.path(), [](H5Writer&) {});
  EXPECT_THAT(message_of([&] { read_mesh(world, file.path(), 1.0); }),
              HasSubstr("m.h5: /rest_positions cannot be read"));
  EXPECT_THAT(message_of([&] { read_mesh(world, "cloth.dae", 1.0); }),
              AllOf(HasSubstr("cloth.dae"), HasSubstr(".obj"), HasSubstr(".h5")));
}
