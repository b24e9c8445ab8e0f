// What a partition would cost, against what it does cost those who are given it.
#include "partition/grid.hpp"
#include "partition/partition_figures.hpp"
#include "partition/yarns.hpp"
#include "tests/support.hpp"

#include <gtest/gtest.h>

using namespace taut;
using namespace taut::test;

namespace {

Spread spread_over_ranks(Global here) {
  return {-max_over(world, -here), max_over(world, here), double(sum_over(world, here)) / size_of(world)};
}

void expect_equal(const Spread& found, const Spread& expected, const char* what) {
  EXPECT_EQ(found.min, expected.min) << what;
  EXPECT_EQ(found.max, expected.max) << what;
  EXPECT_DOUBLE_EQ(found.mean, expected.mean) << what;
}

/// The figures of a partition into as many parts as there are ranks are those of the meshes on the ranks.
void compare_with_ranks(const MeshSlab& slab, const std::vector<int>& owners) {
  const Topology topology = find_topology(world, slab);
  const PartitionFigures figures = partition_figures(world, slab, topology, owners, size_of(world));
  const DistributedMesh mesh = distribute(world, slab, topology, owners);
  const Yarns yarns = find_yarns(mesh);
  EXPECT_EQ(figures.edge_cut, mesh.report.edge_cut);
  EXPECT_DOUBLE_EQ(figures.imbalance, mesh.report.imbalance);
  EXPECT_EQ(figures.ghosts.max, mesh.report.ghosts_max);
  expect_equal(figures.vertices, spread_over_ranks(mesh.vertices.owned), "vertices");
  expect_equal(figures.ghosts, spread_over_ranks(mesh.vertices.ghosts()), "ghosts");
  expect_equal(figures.ghost_edges, spread_over_ranks(mesh.edges.ghosts()), "ghost edges");
  expect_equal(figures.neighbours, spread_over_ranks(mesh.vertex_halo.plan().neighbours()), "neighbours");
  expect_equal(figures.yarn_segments, spread_over_ranks(Global(yarns.segments.size())), "segments");
  EXPECT_EQ(figures.yarns, yarns.count);

  Global cut = 0; // each cut yarn begins once among the knots of its owner
  for (const char starts : yarns.starts_yarn) cut += starts;
  EXPECT_EQ(figures.cut_yarns, sum_over(world, cut));
}

} // namespace

TEST(PartitionFigures, AreThoseOfTheRanksByMetis) {
  const MeshSlab slab = make_grid(world, {2, 1}, {23, 17});
  compare_with_ranks(slab, partition(world, slab, find_topology(world, slab), Partitioner::metis));
}

TEST(PartitionFigures, AreThoseOfTheRanksByStripes) {
  const MeshSlab slab = make_grid(world, {2, 1}, {23, 17});
  compare_with_ranks(slab, partition(world, slab, find_topology(world, slab), Partitioner::stripes));
}

TEST(PartitionFigures, AreThoseOfTheRanksOnAnyMesh) {
  for (const MakeMesh& make : {MakeMesh(mixed_mesh), MakeMesh(triangle_mesh), MakeMesh(tube_mesh)})
    for (unsigned seed = 0; seed < 4; ++seed) {
      const MeshSlab slab = make(world);
      compare_with_ranks(slab, random_owners(slab.vertices, seed));
    }
}

TEST(PartitionFigures, AClosedYarnWithinOnePartIsOneSegment) {
  const MeshSlab slab = tube_mesh(world);
  std::vector<int> rings; // four parts of one ring each: the rings are whole, the lengthwise yarns are cut
  for (Global v = slab.vertices.first; v < slab.vertices.first + slab.vertices.count; ++v)
    rings.push_back(int(v / tube_around));
  const PartitionFigures figures = partition_figures(world, slab, find_topology(world, slab), rings, 4);
  EXPECT_EQ(figures.yarns, 8 + 4);
  EXPECT_EQ(figures.cut_yarns, 8);
  EXPECT_EQ(figures.yarn_segments.min, 1);     // the last ring owns no lengthwise edge
  EXPECT_EQ(figures.yarn_segments.max, 1 + 8); // an edge belongs to its lower vertex
}

TEST(PartitionFigures, DoNotDependOnWhoComputesThem) {
  const auto of = [](MPI_Comm comm) {
    const MeshSlab slab = make_grid(comm, {2, 1}, {23, 17});
    const Topology topology = find_topology(comm, slab);
    return partition_figures(comm, slab, topology, partition(comm, slab, topology, Partitioner::metis, 50),
                             50);
  };
  const PartitionFigures found = of(world), expected = of(MPI_COMM_SELF);
  expect_equal(found.vertices, expected.vertices, "vertices");
  expect_equal(found.ghosts, expected.ghosts, "ghosts");
  expect_equal(found.ghost_edges, expected.ghost_edges, "ghost edges");
  expect_equal(found.neighbours, expected.neighbours, "neighbours");
  expect_equal(found.yarn_segments, expected.yarn_segments, "segments");
  EXPECT_EQ(found.edge_cut, expected.edge_cut);
  EXPECT_EQ(found.cut_yarns, expected.cut_yarns);
  EXPECT_EQ(found.vertices.mean * 50, 23 * 17);
}

TEST(PartitionFigures, OfStripesAreCounted) {
  // A row of 10 vertices, cut in the middle: each half stores two vertices of the other (the end of the cut
  // edge and its neighbour, whose star is stored too).
  const MeshSlab slab = make_line(world, 1, 10);
  const Topology topology = find_topology(world, slab);
  const PartitionFigures figures =
      partition_figures(world, slab, topology, partition(world, slab, topology, Partitioner::stripes, 2), 2);
  expect_equal(figures.vertices, {5, 5, 5.0}, "vertices");
  expect_equal(figures.ghosts, {2, 2, 2.0}, "ghosts");
  expect_equal(figures.neighbours, {1, 1, 1.0}, "neighbours");
  expect_equal(figures.yarn_segments, {1, 1, 1.0}, "segments");
  EXPECT_EQ(figures.edge_cut, 1);
  EXPECT_EQ(figures.cut_yarns, 1);
  EXPECT_EQ(figures.yarns, 1);
}
