// The rest shape in texture coordinates, and a start that is strained against it.
#include "src/state/material_coordinates.hpp"
#include "tests/folder.hpp"
#include "tests/simulate.hpp"

#include <fmt/format.h>

#include <fstream>

using namespace taut;
using namespace taut::test;

namespace {

/// A grid of triangles whose texture is its shape, turned by a quarter and `larger` by so much.
MeshSlab cut_larger(MPI_Comm comm, double larger) {
  MeshSlab mesh = make_grid(self, {0.8, 0.6}, {9, 7}, GridCells::alternating_triangles);
  std::vector<Corners2> texture;
  for (const Cell& cell : mesh.cell) {
    Corners2 corners{Vec2::Zero(), Vec2::Zero(), Vec2::Zero(), Vec2::Zero()};
    for (int k = 0; k < 3; ++k) {
      const Vec3& x = mesh.rest_positions[cell.vertices[k]];
      corners[k] = larger * Vec2(x[1], -x[0]);
    }
    texture.push_back(corners);
  }
  MeshSlab slab = slab_of_whole(comm, mesh.rest_positions, mesh.cell);
  const auto first = texture.begin() + slab.cells.first;
  slab.texture.assign(first, first + slab.cells.count);
  slab.rest_shape = slab.texture;
  return slab;
}

/// The same as a file, in which a unit of texture is `unit` m.
void write_cut_larger(const std::filesystem::path& file, double larger, double unit) {
  if (rank_of(world) == 0) {
    std::ofstream out(file);
    const MeshSlab mesh = make_grid(self, {0.8, 0.6}, {9, 7}, GridCells::alternating_triangles);
    for (const Vec3& x : mesh.rest_positions)
      out << fmt::format("v {} {} {}\nvt {} {}\n", x[0], x[1], x[2], larger / unit * x[1],
                         -larger / unit * x[0]);
    for (const Cell& c : mesh.cell)
      out << fmt::format("f {0}/{0} {1}/{1} {2}/{2}\n", c.vertices[0] + 1, c.vertices[1] + 1,
                         c.vertices[2] + 1);
  }
  MPI_Barrier(world);
}

Case case_with(const std::filesystem::path& mesh, const std::string& unit) {
  return case_of(fmt::format("cloth: {{mesh: {}, rest: texture, texture_unit: {}}}\n"
                             "time: {{end: 0.1, frame_rate: 10, max_step: 0.01}}\n",
                             mesh.string(), unit));
}

} // namespace

TEST(RestShape, OfTheTextureHasItsLengthsAreasAndWarp) {
  on_odd_partitions([](MPI_Comm comm) { return cut_larger(comm, 1.1); },
                    [](DistributedMesh mesh) {
                      const Cloth cloth = make_cloth(std::move(mesh), config::Material{});
                      const auto& x = cloth.mesh.rest_positions;
                      for (std::size_t e = 0; e < cloth.rest_length.size(); ++e) {
                        const auto& [a, b] = cloth.mesh.edge_vertices[e];
                        EXPECT_NEAR(cloth.rest_length[e], 1.1 * (x[b] - x[a]).norm(), 1e-14);
                      }
                      double area = 0;
                      for (Local i = 0; i < cloth.mesh.vertices.owned; ++i) area += cloth.measure[i];
                      EXPECT_NEAR(sum_over(world, area), 1.21 * 0.48, 1e-13);
                      for (std::size_t c = 0; c < cloth.mesh.cells.size(); ++c) {
                        const auto& v = cloth.mesh.cells[c].vertices;
                        const Corners2 m = material_coordinates(cloth.mesh, c);
                        EXPECT_NEAR(m[1][0], 1.1 * (x[v[1]] - x[v[0]])[1], 1e-14); // warp along y
                      }
                    });
}

TEST(RestShape, AStartThatIsStrainedAgainstItIsRelaxed) {
  const Folder folder;
  const auto file = folder / "cut.obj";
  write_cut_larger(file, 1.05, 0.01);
  Simulation simulation(world, case_with(file, "1 cm"));
  const double limit = *simulation.strain_limit();
  EXPECT_GT(simulation.gauge().measure(simulation.state().positions).max, 4 * limit);
  const Relaxed relaxed = simulation.relax();
  EXPECT_TRUE(relaxed.succeeded());
  EXPECT_GT(relaxed.strain_before, 4);
  EXPECT_GT(relaxed.steps, 0);
  EXPECT_LE(simulation.gauge().measure(simulation.state().positions).max, limit);
  EXPECT_EQ(simulation.state().time, 0);
  for (const Vec3& v : simulation.state().velocities) EXPECT_EQ(v, Vec3(Vec3::Zero()));
  EXPECT_EQ(simulation.relax().steps, 0); // nothing is left to do
}

TEST(RestShape, AStartThatIsStrainedTooFarIsLeft) {
  const Folder folder;
  const auto file = folder / "cut.obj";
  write_cut_larger(file, 3, 1);
  Simulation simulation(world, case_with(file, "1 m"));
  const Relaxed relaxed = simulation.relax();
  EXPECT_FALSE(relaxed.succeeded());
  EXPECT_EQ(relaxed.steps, 0);
}
