// Garments that are sewn: what is joined, how long its sides are, files.
#include "io/mesh_file.hpp"
#include "partition/topology.hpp"
#include "src/garment/named_parts.hpp"
#include "src/garment/write_mesh.hpp"
#include "tests/garment/patterns.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <set>

using namespace taut;
using namespace taut::garment;
using namespace taut::test;
namespace fs = std::filesystem;

namespace {

const MPI_Comm world = MPI_COMM_WORLD;

GarmentMesh shirt() { return mesh_garment(pattern_in("cases/shirt/shirt.json"), {0.03, {}}); }
GarmentMesh skirt() { return mesh_garment(pattern_in("cases/skirt-pattern/skirt.yaml"), {0.02, {}}); }

double area_of(const Corners2& c, int corners) {
  double twice = 0;
  for (int k = 0; k < corners; ++k) {
    const Vec2 &a = c[k], &b = c[(k + 1) % corners];
    twice += a[0] * b[1] - b[0] * a[1];
  }
  return 0.5 * twice;
}

/// Two squares of 20 cm, the edge of one gathered onto the shorter edge of a third panel.
const std::string gathered = "panels:\n" + rectangle("wide", 0.2, 0.1) + rectangle("band", 0.12, 0.04) +
                             "stitches: [[{panel: wide, edge: 2}, {panel: band, edge: 0}]]\n";

} // namespace

TEST(Sewn, VerticesOfSeveralSeamsAreOne) {
  for (const GarmentMesh& mesh : {shirt(), skirt()}) {
    const auto joint = joints_of(mesh);
    const SewnMesh sewn = sew(mesh, mesh.positions, "shirt");
    std::set<Global> joints(joint.begin(), joint.end());
    EXPECT_EQ(sewn.positions.size(), joints.size());
    EXPECT_EQ(sewn.cells.size(), mesh.cells.size());
    for (const MeshedSeam& seam : mesh.seams)
      for (const auto& [a, b] : seam.pairs) EXPECT_EQ(sewn.number[a], sewn.number[b]);
    for (std::size_t v = 0; v < joint.size(); ++v)
      for (std::size_t w = 0; w < v; ++w) EXPECT_EQ(sewn.number[v] == sewn.number[w], joint[v] == joint[w]);
  }
}

TEST(Sewn, LieInTheMiddle) {
  const GarmentMesh mesh = shirt();
  const SewnMesh sewn = sew(mesh, mesh.positions, "shirt");
  std::vector<Vec3> sum(sewn.positions.size(), Vec3::Zero());
  std::vector<int> count(sum.size(), 0);
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    sum[sewn.number[v]] += mesh.positions[v];
    ++count[sewn.number[v]];
  }
  for (std::size_t v = 0; v < sum.size(); ++v)
    EXPECT_LT((sum[v] / count[v] - sewn.positions[v]).norm(), 1e-12);
}

TEST(Sewn, CellsAgreeOnTheLengthsOfSides) {
  for (const GarmentMesh& mesh : {shirt(), skirt(), mesh_garment(pattern_of(gathered), {0.01, {}})}) {
    const SewnMesh sewn = sew(mesh, mesh.positions, "shirt");
    std::map<std::pair<Global, Global>, double> lengths;
    double area = 0, of_panels = 0;
    for (std::size_t c = 0; c < sewn.cells.size(); ++c) {
      const int n = sewn.cells[c].size();
      area += area_of(sewn.rest_shape[c], n);
      of_panels += std::abs(area_of(sewn.texture[c], n));
      EXPECT_GT(std::abs(area_of(sewn.rest_shape[c], n)), 0.0);
      for (int k = 0; k < n; ++k) {
        const Global a = sewn.cells[c].vertices[k], b = sewn.cells[c].vertices[(k + 1) % n];
        const double length = (sewn.rest_shape[c][(k + 1) % n] - sewn.rest_shape[c][k]).norm();
        const auto [entry, is_new] = lengths.try_emplace(std::minmax(a, b), length);
        EXPECT_NEAR(length, is_new ? length : entry->second, 1e-9);
      }
    }
    EXPECT_NEAR(area, of_panels, 0.05 * of_panels);
  }
}

TEST(Sewn, GathersToTheShorterEdge) {
  const GarmentMesh mesh = mesh_garment(pattern_of(gathered), {0.01, {}});
  const SewnMesh sewn = sew(mesh, mesh.positions, "shirt");
  const auto& seam = sewn.seam.front();
  double length = 0; // of the seam, each of its sides once
  std::set<std::pair<Global, Global>> met;
  for (std::size_t c = 0; c < sewn.cells.size(); ++c)
    for (int k = 0, n = sewn.cells[c].size(); k < n; ++k) {
      const Global a = sewn.cells[c].vertices[k], b = sewn.cells[c].vertices[(k + 1) % n];
      const bool on_seam =
          std::binary_search(seam.begin(), seam.end(), a) && std::binary_search(seam.begin(), seam.end(), b);
      if (on_seam && met.insert(std::minmax(a, b)).second)
        length += (sewn.rest_shape[c][(k + 1) % n] - sewn.rest_shape[c][k]).norm();
    }
  EXPECT_NEAR(length, 0.12, 1e-9);
}

TEST(Sewn, ElasticEdgesAreShorterAndTheClothBesideThemIsNot) {
  const GarmentMesh mesh = mesh_garment(
      pattern_of("panels:\n" + rectangle("front", 0.2, 0.1, "    label: all\n") + "stitches: []\n"),
      {0.01, {}});
  ShorterSides waist{"waist", {}, 0.7};
  for (Global v = 0; v < Global(mesh.positions.size()); ++v)
    if (mesh.positions[v][1] > 0.1 - 1e-9) waist.vertices.push_back(v);
  const SewnMesh sewn = sew(mesh, mesh.positions, "skirt", std::span(&waist, 1));
  double elastic = 0, plain = 0;
  for (std::size_t c = 0; c < sewn.cells.size(); ++c)
    for (int k = 0, n = sewn.cells[c].size(); k < n; ++k) {
      const Global a = sewn.cells[c].vertices[k], b = sewn.cells[c].vertices[(k + 1) % n];
      const double now = (sewn.rest_shape[c][(k + 1) % n] - sewn.rest_shape[c][k]).norm(),
                   cut = (sewn.texture[c][(k + 1) % n] - sewn.texture[c][k]).norm();
      const bool is_elastic =
          std::ranges::binary_search(waist.vertices, a) && std::ranges::binary_search(waist.vertices, b);
      EXPECT_NEAR(now, (is_elastic ? 0.7 : 1) * cut, 1e-9);
      (is_elastic ? elastic : plain) += now;
    }
  EXPECT_NEAR(elastic, 0.7 * 0.2, 1e-9);
  EXPECT_GT(plain, 1.0);
  const ShorterSides all{"all", mesh.labels.at("all"), 0.8}; // quads too
  const SewnMesh small = sew(mesh, mesh.positions, "skirt", std::span(&all, 1));
  for (std::size_t c = 0; c < small.cells.size(); ++c)
    EXPECT_NEAR(area_of(small.rest_shape[c], small.cells[c].size()),
                0.64 * area_of(small.texture[c], small.cells[c].size()), 1e-12);
}

// A front and a back that both face forwards, as in trousers: joined side by side, right side to wrong side.
TEST(Sewn, TurnsPanelsRoundWhoseWrongSideGoesOn) {
  const std::string panels = "panels:\n" + rectangle("front", 0.2, 0.1) + rectangle("back", 0.2, 0.1);
  const auto sewn_of = [&](const std::string& stitches) {
    const GarmentMesh mesh = mesh_garment(pattern_of(panels + "stitches: [" + stitches + "]\n"), {0.02, {}});
    const SewnMesh sewn = sew(mesh, mesh.positions, "tube");
    std::set<std::pair<Global, Global>> directed;
    for (std::size_t c = 0; c < sewn.cells.size(); ++c)
      for (int k = 0, n = sewn.cells[c].size(); k < n; ++k) {
        EXPECT_TRUE(directed.insert({sewn.cells[c].vertices[k], sewn.cells[c].vertices[(k + 1) % n]}).second);
        const double length = (sewn.texture[c][(k + 1) % n] - sewn.texture[c][k]).norm();
        EXPECT_NEAR((sewn.rest_shape[c][(k + 1) % n] - sewn.rest_shape[c][k]).norm(), length, 1e-12);
        EXPECT_GT(area_of(sewn.rest_shape[c], n), 0.0);
      }
    return sewn;
  };
  const auto seam = [](int edge, int other, const char* more) {
    return "[{panel: front, edge: " + std::to_string(edge) +
           "}, {panel: back, edge: " + std::to_string(other) + "}" + more + "]";
  };
  const SewnMesh sewn = sewn_of(seam(1, 1, ", right_wrong") + ", " + seam(3, 3, ", right_wrong"));
  EXPECT_GT(area_of(sewn.texture.front(), sewn.cells.front().size()), 0.0);
  EXPECT_LT(area_of(sewn.texture.back(), sewn.cells.back().size()), 0.0);
  EXPECT_THROW(sewn_of(seam(1, 1, ", right_wrong") + ", " + seam(3, 3, "")), InputError);
}

TEST(Sewn, IsReadAgainAsAMeshWithoutFault) {
  std::string folder = (fs::temp_directory_path() / "taut-sewn-XXXXXX").string();
  folder = broadcast(world, [&] { return std::string(mkdtemp(folder.data())); });
  const fs::path file = fs::path(folder) / "sewn.h5";
  for (const GarmentMesh& mesh : {shirt(), skirt()}) {
    const SewnMesh sewn = sew(mesh, mesh.positions, "shirt");
    write_h5(world, mesh, sewn, file);
    const MeshSlab slab = read_mesh_h5(world, file, 1);
    EXPECT_EQ(slab.vertices.total, Global(sewn.positions.size()));
    for (std::size_t c = 0; c < slab.cell.size(); ++c)
      for (int k = 0; k < slab.cell[c].size(); ++k)
        EXPECT_EQ(slab.rest_shape[c][k], sewn.rest_shape[std::size_t(slab.cells.first) + c][k]);
    const Topology topology = find_topology(world, slab); // refuses flipped faces and third ones
    for (const EdgeFaces& hinge : topology.hinges) EXPECT_GT(hinge.at_rest.length, 0.0);
    const NamedParts parts = read_named_parts(world, file), expected = parts_of(mesh, sewn);
    EXPECT_EQ(parts.labels, sewn.labels);
    ASSERT_EQ(parts.panels.size(), mesh.panels.size());
    for (std::size_t p = 0; p < parts.panels.size(); ++p) {
      EXPECT_EQ(parts.panels[p].name, mesh.panels[p].name);
      EXPECT_EQ(parts.panels[p].first_cell, mesh.panels[p].first_cell);
      EXPECT_EQ(parts.panel_of(mesh.panels[p].first_cell + mesh.panels[p].cells - 1), int(p));
    }
    ASSERT_EQ(parts.seams.size(), expected.seams.size());
    for (std::size_t s = 0; s < parts.seams.size(); ++s) {
      EXPECT_EQ(parts.seams[s].name, expected.seams[s].name);
      EXPECT_EQ(parts.seams[s].vertices, expected.seams[s].vertices);
    }
  }
  MPI_Barrier(world);
  if (rank_of(world) == 0) fs::remove_all(folder);
}
