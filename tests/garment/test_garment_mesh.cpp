// Whole garments: seams, darts, labels, right sides, files.
#include "io/hdf5.hpp"
#include "io/mesh_file.hpp"
#include "partition/fetch.hpp"
#include "partition/topology.hpp"
#include "src/garment/draw_svg.hpp"
#include "src/garment/write_mesh.hpp"
#include "src/state/start.hpp"
#include "tests/garment/patterns.hpp"

#include <Eigen/Geometry>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>
#include <set>

using namespace taut;
using namespace taut::garment;
using namespace taut::test;
namespace fs = std::filesystem;

namespace {

const MPI_Comm world = MPI_COMM_WORLD;
constexpr double degree = std::numbers::pi / 180;

GarmentMesh shirt(double edge) { return mesh_garment(pattern_in("cases/shirt/shirt.json"), {edge, {}}); }
GarmentMesh skirt(double edge) {
  return mesh_garment(pattern_in("cases/skirt-pattern/skirt.yaml"), {edge, {}});
}

/// Of each panel: the mean normal of its cells in space.
std::vector<Vec3> normals(const GarmentMesh& mesh) {
  std::vector<Vec3> all;
  for (const MeshedPanel& panel : mesh.panels) {
    Vec3 sum = Vec3::Zero();
    for (Global c = panel.first_cell; c < panel.first_cell + panel.cells; ++c) {
      const auto& v = mesh.cells[c].vertices;
      sum += (mesh.positions[v[1]] - mesh.positions[v[0]]).cross(mesh.positions[v[2]] - mesh.positions[v[0]]);
    }
    all.push_back(sum.normalized());
  }
  return all;
}

/// Distances from each vertex of one side of a seam to the next, over their mean.
std::vector<double> steps(const GarmentMesh& mesh, const MeshedSeam& seam, int side) {
  std::vector<double> steps;
  double sum = 0;
  for (std::size_t i = 1; i < seam.pairs.size(); ++i) {
    steps.push_back((mesh.positions[seam.pairs[i][side]] - mesh.positions[seam.pairs[i - 1][side]]).norm());
    sum += steps.back();
  }
  for (double& s : steps) s *= double(steps.size()) / sum;
  return steps;
}

/// The file `name`, gone at the end; the same on all ranks.
class TemporaryFile {
public:
  explicit TemporaryFile(const std::string& name) {
    folder_ = broadcast(world, [] {
      std::string folder = (fs::temp_directory_path() / "taut-garment-XXXXXX").string();
      return std::string(mkdtemp(folder.data()));
    });
    path_ = folder_ / name;
  }
  ~TemporaryFile() {
    MPI_Barrier(world);
    if (rank_of(world) == 0) fs::remove_all(folder_);
  }
  const fs::path& path() const { return path_; }

private:
  fs::path folder_, path_;
};

void expect_same(const MeshSlab& read, const MeshSlab& made, double tolerance) {
  ASSERT_EQ(read.vertices.total, made.vertices.total);
  ASSERT_EQ(read.cells.total, made.cells.total);
  for (std::size_t v = 0; v < made.rest_positions.size(); ++v)
    ASSERT_LE((read.rest_positions[v] - made.rest_positions[v]).norm(), tolerance);
  ASSERT_EQ(read.texture.size(), made.texture.size());
  for (std::size_t c = 0; c < made.cell.size(); ++c) {
    ASSERT_EQ(read.cell[c].vertices, made.cell[c].vertices);
    for (int k = 0; k < made.cell[c].size(); ++k)
      ASSERT_LE((read.texture[c][k] - made.texture[c][k]).norm(), tolerance);
  }
}

/// The edges from each of n vertices to the next, around a panel.
std::string loop(int n) {
  std::string edges;
  for (int i = 0; i < n; ++i)
    edges += fmt::format("{}{{endpoints: [{}, {}]}}", i ? ", " : "", i, (i + 1) % n);
  return edges;
}

} // namespace

TEST(GarmentMesh, OfAShirtHasGoodTrianglesAtAnySize) {
  for (const double edge : {0.03, 0.02, 0.01, 0.005}) {
    const auto mesh = shirt(edge);
    ASSERT_EQ(mesh.panels.size(), 8u);
    EXPECT_EQ(mesh.warnings.size(), edge == 0.03 ? 1u : 0u); // it has edges of 7.5 mm
    for (const auto& panel : mesh.panels) EXPECT_GT(panel.sharpest.angle, 20 * degree) << edge << panel.name;
  }
}

TEST(GarmentMesh, SamplesBothSidesOfASeamAlike) {
  const auto mesh = shirt(0.008);
  const auto pattern = pattern_in("cases/shirt/shirt.json");
  ASSERT_EQ(mesh.seams.size(), 18u);
  for (std::size_t s = 0; s < mesh.seams.size(); ++s) {
    const MeshedSeam& seam = mesh.seams[s];
    EXPECT_EQ(seam.pairs.size(),
              std::size_t(std::ceil(*std::ranges::max_element(seam.lengths) / 0.008 - 0.25)) + 1);
    for (const int side : {0, 1})
      for (const double step : steps(mesh, seam, side)) EXPECT_NEAR(step, 1, 0.01) << seam.name;
    // start to end
    const auto& [one, two] = pattern.seams[s].sides;
    const auto &a = mesh.panels[one.panel], &b = mesh.panels[two.panel];
    EXPECT_EQ(seam.pairs.front()[0], a.first_vertex + a.outline.of_edge(one.edge).front());
    EXPECT_EQ(seam.pairs.front()[1], b.first_vertex + b.outline.of_edge(two.edge).back());
  }
}

TEST(GarmentMesh, SewsDartsGathersAndRightToWrong) {
  const auto mesh = skirt(0.01);
  EXPECT_EQ(mesh.seams[0].pairs.size(), 10u); // the tip of the dart is one vertex
  for (const auto& [a, b] : mesh.seams[0].pairs)
    EXPECT_NEAR(mesh.positions[a][1], mesh.positions[b][1], 1e-12); // its legs mirror one another
  EXPECT_EQ(mesh.labels.at("lower_interface").size(), 2u * 76u);
  for (const Global v : mesh.labels.at("lower_interface")) EXPECT_NEAR(mesh.positions[v][1], 1.12, 1e-12);
  const auto curves = mesh_garment(pattern_in("tests/garment/curves.yaml"), {0.01, {}});
  const auto &leaf = curves.panels[1], &disc = curves.panels[0];
  EXPECT_EQ(curves.seams[0].pairs.front()[0], leaf.first_vertex + leaf.outline.of_edge(2).front());
  EXPECT_EQ(curves.seams[0].pairs.front()[1], disc.first_vertex + disc.outline.of_edge(0).front());
  EXPECT_EQ(Global(curves.labels.at("greenery").size()), leaf.vertices);
  EXPECT_EQ(curves.labels.at("tip").size(), leaf.outline.of_edge(2).size() + leaf.outline.of_edge(5).size());
}

TEST(GarmentMesh, DrawsEdgesFarShorterThanItsOwnToPoints) {
  // two panels, sewn along three edges, the middle one of 1 mm
  const std::string text =
      "panels:\n"
      "  a: {vertices: [[0, 0], [0.3, 0], [0.3, 0.1], [0.3, 0.101], [0.3, 0.2], [0, 0.2]], edges: [" +
      loop(6) +
      "]}\n"
      "  b: {vertices: [[0, -0.1], [0, -0.2], [0.2, -0.2], [0.2, 0], [0, 0], [0, -0.099]], edges: [" +
      loop(6) +
      "]}\nstitches:\n  - [{panel: a, edge: 1}, {panel: b, edge: 0}]\n"
      "  - [{panel: a, edge: 2}, {panel: b, edge: 5}]\n  - [{panel: a, edge: 3}, {panel: b, edge: 4}]\n";
  const auto mesh = mesh_garment(pattern_of(text), {0.01, {}});
  ASSERT_EQ(mesh.warnings.size(), 1u);
  EXPECT_EQ(mesh.warnings[0], "shirt.yaml: a.2 (1 mm) and 1 more are shorter than a quarter of the mesh's "
                              "edges and become points of it; shorter edges keep them");
  ASSERT_EQ(mesh.seams[1].pairs.size(), 1u);
  const auto [a, b] = mesh.seams[1].pairs[0];
  EXPECT_NEAR(mesh.positions[a][1], 0.1005, 1e-12); // in its middle
  EXPECT_NEAR(mesh.positions[b][1], -0.0995, 1e-12);
  EXPECT_EQ(mesh.seams[0].pairs.back(), mesh.seams[1].pairs[0]);
  EXPECT_EQ(mesh.seams[2].pairs.front(), mesh.seams[1].pairs[0]);
  for (const auto& seam : mesh.seams)
    for (const int side : {0, 1})
      for (const double step : steps(mesh, seam, side)) EXPECT_GT(step, 0.9);
  EXPECT_TRUE(mesh_garment(pattern_of(text), {0.003, {}}).warnings.empty());
}

TEST(GarmentMesh, KeepsAnOutlineOfShortEdgesAlone) {
  // a disc of 60 edges of 2 mm: every second one is a point
  std::string vertices;
  for (int i = 0; i < 60; ++i)
    vertices += fmt::format("{}[{}, {}]", i ? ", " : "", 0.0191 * std::cos(i * std::numbers::pi / 30),
                            0.0191 * std::sin(i * std::numbers::pi / 30));
  const auto mesh = mesh_garment(
      pattern_of("panels: {a: {vertices: [" + vertices + "], edges: [" + loop(60) + "]}}"), {0.009, {}});
  EXPECT_EQ(mesh.panels[0].outline.points.size(), 30u);
  EXPECT_EQ(mesh.panels[0].outline.of_edge(58), (std::vector<int>{29}));
  EXPECT_EQ(mesh.panels[0].outline.of_edge(59), (std::vector<int>{29, 0}));
}

TEST(GarmentMesh, WarnsOfUnequalSeams) {
  const std::string text = "panels:\n" + rectangle("a", 0.3, 0.3) + rectangle("b", 0.1, 0.3) +
                           "stitches:\n  - [{panel: a, edge: 0}, {panel: b, edge: 2}]\n";
  const auto mesh = mesh_garment(pattern_of(text), {0.01, {}});
  ASSERT_EQ(mesh.warnings.size(), 1u);
  EXPECT_EQ(mesh.warnings[0],
            "shirt.yaml:9:5: seam a.0-b.2 joins edges of 0.3 m and 0.1 m, gathered 3.0 : 1; if that is "
            "not meant, correct panel or edge of the stitch");
}

TEST(GarmentMesh, TurnsRightSidesOutwardsAndWarpAlongTheGrain) {
  const auto mesh = shirt(0.02);
  const auto all = normals(mesh);
  for (std::size_t p = 0; p < all.size(); ++p) {
    const bool front = mesh.panels[p].name.find("_f") != std::string::npos;
    EXPECT_NEAR(all[p][2], front ? 1 : -1, 1e-9) << mesh.panels[p].name;
  }
  for (const Cell& cell : mesh.cells) { // u and v are as in space, counter-clockwise; quads are along them
    const Corners2 uv = texture_of(mesh, cell);
    const Vec2 one = uv[1] - uv[0], two = uv[2] - uv[1];
    EXPECT_GT(one[0] * two[1] - one[1] * two[0], 0);
    EXPECT_NEAR(one.norm(), (mesh.positions[cell.vertices[1]] - mesh.positions[cell.vertices[0]]).norm(),
                1e-12);
    if (cell.size() == 4) {
      EXPECT_NEAR(std::max(std::abs(one[0]), std::abs(one[1])), 0.02, 1e-12);
    }
  }
  const std::string text = "panels:\n" + rectangle("a", 0.3, 0.3, "    grain: 30\n");
  const auto turned = mesh_garment(pattern_of(text), {0.01, {}});
  const Cell& quad = turned.cells.front();
  const Corners2 uv = texture_of(turned, quad);
  const Vec3 side = turned.positions[quad.vertices[1]] - turned.positions[quad.vertices[0]];
  const Vec3 warp(-std::sin(30 * degree), std::cos(30 * degree), 0);
  EXPECT_NEAR(side.dot(warp), uv[1][0] - uv[0][0], 1e-12);
}

TEST(GarmentMesh, TakesEdgeLengthsOfPanels) {
  const auto pattern = pattern_in("cases/skirt-pattern/skirt.yaml");
  const auto mesh = mesh_garment(pattern, {0.01, {{"back_band", 0.008}}});
  EXPECT_EQ(mesh.panels[2].edge_length, 0.004);
  EXPECT_EQ(mesh.panels[3].edge_length, 0.008);
  EXPECT_GT(mesh.panels[2].vertices, 2 * mesh.panels[3].vertices);
  EXPECT_THROW(mesh_garment(pattern, {0.01, {{"bakc_band", 0.008}}}), InputError);
}

TEST(GarmentFiles, AreWhatTautReads) {
  const GarmentMesh made = rank_of(world) == 0 ? skirt(0.01) : GarmentMesh{};
  const MeshSlab slab = share_out(world, made, "skirt");
  find_topology(world, slab); // finds nothing wrong
  const TemporaryFile obj("skirt.obj"), h5("skirt.h5");
  write_obj(world, made, obj.path());
  expect_same(read_mesh(world, obj.path(), 1), slab, 0);
  write_h5(world, made, h5.path());
  expect_same(read_mesh(world, h5.path(), 1), slab, 0);
}

TEST(GarmentFiles, HoldPanelsSeamsAndLabels) {
  const GarmentMesh all = skirt(0.02), made = rank_of(world) == 0 ? all : GarmentMesh{};
  const TemporaryFile h5("skirt.h5");
  write_h5(world, made, h5.path());
  const H5Reader file(world, h5.path());
  EXPECT_EQ(file.attribute<std::string>("panels"), R"(["front","back","front_band","back_band"])");
  EXPECT_EQ(file.attribute<std::string>("labels"), R"(["hem","lower_interface"])");
  EXPECT_EQ(file.rows("/cells/panel"), Global(all.cells.size()));
  EXPECT_EQ(file.rows("/seams/offsets"), Global(all.seams.size()) + 1);
  EXPECT_EQ(file.columns("/seams/pairs"), 2);
  EXPECT_EQ(file.rows("/labels/vertices"),
            Global(all.labels.at("hem").size() + all.labels.at("lower_interface").size()));
  const GarmentMesh bare = mesh_garment(pattern_of("panels:\n" + rectangle("a", 0.3, 0.3)), {0.02, {}});
  write_h5(world, rank_of(world) == 0 ? bare : GarmentMesh{}, h5.path()); // without seams and labels
}

TEST(GarmentInACase, IsMeshedWithTheEdgeLengthOfTheCase) {
  const auto read = [](const std::string& more) {
    const std::string text = "cloth: {pattern: skirt.yaml, edge: 2 cm" + more + "}\n";
    const Case input = read_case(text, std::string(TAUT_SOURCE_DIR) + "/cases/skirt-pattern/case.yaml");
    return read_cloth(world, input).mesh.slab;
  };
  MeshSlab slab = share_out(world, rank_of(world) == 0 ? skirt(0.02) : GarmentMesh{}, "skirt");
  expect_same(read(", up: z"), slab, 0);
  for (Vec3& p : slab.rest_positions) p = Vec3(p[0], -p[2], p[1]);
  expect_same(read(""), slab, 0);
}

TEST(Drawing, ShowsPanelsAndSeams) {
  const std::string svg = draw_svg(skirt(0.02));
  for (const char* part : {"<svg ", ">front_band<", ">13</text>", "</svg>"})
    EXPECT_NE(svg.find(part), std::string::npos) << part;
}
