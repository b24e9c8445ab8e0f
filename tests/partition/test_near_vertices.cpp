#include "partition/grid.hpp"
#include "partition/join.hpp"
#include "partition/partitioner.hpp"
#include "tests/meshes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

using namespace taut;
using namespace taut::test;

namespace {

std::vector<Vec3> random_places(int count) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> in(-1, 1);
  std::vector<Vec3> places;
  for (int i = 0; i < count; ++i) places.emplace_back(in(random), in(random), in(random));
  return places;
}

Slab slab_here(Global total) { return slab_of(total, size_of(world), rank_of(world)); }

void compare_with_all_pairs(const std::vector<Vec3>& places, double reach) {
  const Slab slab = slab_here(Global(places.size()));
  const auto near = find_near(world, slab, std::span(places).subspan(slab.first, slab.count), reach);
  ASSERT_EQ(near.begin.size(), std::size_t(slab.count) + 1);
  for (Global i = 0; i < slab.count; ++i) {
    std::vector<Global> others;
    for (Global j = 0; j < slab.total; ++j)
      if (j != slab.first + i && (places[slab.first + i] - places[j]).norm() < reach) others.push_back(j);
    EXPECT_EQ(others, std::vector<Global>(near.others.begin() + std::ptrdiff_t(near.begin[i]),
                                          near.others.begin() + std::ptrdiff_t(near.begin[i + 1])));
  }
}

/// Squares of 21 x 21 vertices, the second half an edge above the first.
ListedMesh two_layers() {
  std::vector<ListedMesh> layers;
  for (int k = 0; k < 2; ++k) {
    const MeshSlab slab = make_grid(world, {1, 1}, {21, 21});
    layers.push_back({slab, find_topology(world, slab)});
    for (Vec3& p : layers.back().slab.rest_positions) p[2] = 0.025 * k;
  }
  return join(world, layers);
}

PartitionGraph graph_of_layers(const ListedMesh& mesh) {
  const double reach = 1.2 * mean_edge(world, mesh.slab, mesh.topology);
  return graph_of(mesh.topology, find_near(world, mesh.slab.vertices, mesh.slab.rest_positions, reach));
}

/// Vertices of one layer that are on another rank than those above or below them.
int torn_apart(const ListedMesh& mesh, const std::vector<int>& owners) {
  std::vector<double> owner_of(mesh.slab.vertices.total, 0.0);
  for (std::size_t i = 0; i < owners.size(); ++i) owner_of[mesh.slab.vertices.first + i] = owners[i];
  sum_in_place(world, owner_of);
  int torn = 0;
  for (int i = 0; i < 441; ++i) torn += owner_of[i] != owner_of[441 + i];
  return torn;
}

} // namespace

TEST(NearVertices, AreThoseOfAllPairs) {
  for (const double reach : {0.05, 0.3, 3.0}) compare_with_all_pairs(random_places(150), reach);
}

TEST(NearVertices, OfFewerVerticesThanRanks) { compare_with_all_pairs(random_places(5), 1.0); }

TEST(NearVertices, InOnePlace) { compare_with_all_pairs(std::vector<Vec3>(7, Vec3(-0.5, 0, 2)), 0.1); }

TEST(NearVertices, OnTheBordersOfCells) {
  std::vector<Vec3> places;
  for (int i = -6; i < 6; ++i) places.emplace_back(0.1 * i, -0.2 * (i % 3), 0);
  compare_with_all_pairs(places, 0.1);
  compare_with_all_pairs(places, 0.2);
}

TEST(NearVertices, MeanEdgeOfAGrid) {
  const MeshSlab slab = make_grid(world, {2, 3}, {11, 11});
  EXPECT_NEAR(mean_edge(world, slab, find_topology(world, slab)), 0.25, 1e-12);
}

TEST(PartitionGraph, VerticesWithOthersNearAreWork) {
  const ListedMesh mesh = two_layers();
  const PartitionGraph graph = graph_of_layers(mesh);
  for (std::size_t i = 0; i < graph.work.size(); ++i) {
    const Global at = (mesh.slab.vertices.first + Global(i)) % 441, x = at % 21, y = at / 21;
    const int in_the_star = int(mesh.topology.star[i + 1] - mesh.topology.star[i]);
    const bool inside = x > 0 && x < 20 && y > 0 && y < 20;
    if (inside) { // the one above or below, and four around that
      EXPECT_EQ(graph.work[i], 1 + 5);
    }
    EXPECT_EQ(int(graph.begin[i + 1] - graph.begin[i]), in_the_star + graph.work[i] - 1);
  }
}

TEST(Partition, LayersAreCutTogether) {
  const ListedMesh mesh = two_layers();
  const int ranks = size_of(world);
  for (const Partitioner method : {Partitioner::metis, Partitioner::ptscotch}) {
    const auto cut = partition(world, mesh.slab.vertices, graph_of_layers(mesh), method, ranks);
    EXPECT_LE(torn_apart(mesh, cut), 12 * (ranks - 1)) << ranks;
    if (ranks == 2) {
      EXPECT_EQ(torn_apart(mesh, partition(world, mesh.slab, mesh.topology, method)), 441);
    }
  }
}
