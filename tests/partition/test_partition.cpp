#include "partition/distributed_mesh.hpp"
#include "partition/fetch.hpp"
#include "partition/grid.hpp"
#include "partition/item_type.hpp"
#include "tests/meshes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <random>
#include <set>

using namespace taut;
using namespace taut::test;

namespace {

/// Two squares of 2 x 2 quads far apart.
MeshSlab two_pieces() {
  std::vector<Vec3> points;
  std::vector<Cell> cells;
  for (int piece = 0; piece < 2; ++piece) {
    const Global base = 9 * piece;
    for (int i = 0; i < 9; ++i) points.emplace_back(i % 3 + 10.0 * piece, i / 3, 0);
    for (const Global c : {0, 1, 3, 4})
      cells.push_back({{base + c, base + c + 1, base + c + 4, base + c + 3}});
  }
  return slab_of_whole(world, points, cells);
}

/// Everything that must hold for any mesh and any partition of it.
void check(const MeshSlab& slab, const std::vector<int>& owners) {
  const Topology topology = find_topology(world, slab);
  const DistributedMesh mesh = distribute(world, slab, topology, owners);
  EXPECT_EQ(mesh.vertices.total, slab.vertices.total);
  EXPECT_EQ(mesh.edges.total, topology.constrained_edges);
  EXPECT_EQ(sum_over(world, Global(mesh.vertices.owned)), slab.vertices.total);
  EXPECT_EQ(sum_over(world, Global(mesh.owned_cells.size())), slab.cells.total);

  // Halo, forth: ghosts hold what their owners hold.
  std::vector<Global> numbers(mesh.vertices.size(), -1);
  for (Local i = 0; i < mesh.vertices.owned; ++i) numbers[i] = mesh.vertices.original[i];
  mesh.vertex_halo.update(numbers);
  EXPECT_EQ(numbers, mesh.vertices.original);
  for (Local i = 0; i < mesh.vertices.owned; ++i) numbers[i] = mesh.vertices.global(i);
  mesh.vertex_halo.update(numbers);
  for (Local i = 0; i < mesh.vertices.size(); ++i) EXPECT_EQ(numbers[i], mesh.vertices.global(i));

  // Halo, back: every copy of a vertex adds one.
  std::vector<double> copies(mesh.vertices.size(), 1.0);
  mesh.vertex_halo.accumulate(copies);
  const double held = std::accumulate(copies.begin(), copies.begin() + mesh.vertices.owned, 0.0);
  EXPECT_EQ(sum_over(world, held), sum_over(world, double(mesh.vertices.size())));

  // To the original order and back.
  const auto rows = mesh.vertex_order.to_slab<Global>(mesh.vertices.original);
  for (Global i = 0; i < Global(rows.size()); ++i) EXPECT_EQ(rows[i], mesh.vertex_order.slab().first + i);
  std::vector<Global> back(mesh.vertices.owned);
  mesh.vertex_order.from_slab<Global>(rows, back);
  EXPECT_TRUE(std::equal(back.begin(), back.end(), mesh.vertices.original.begin()));

  // The stars of owned vertices and of their neighbours are whole.
  const auto degree_of = [&](Local v) {
    Global degree = 0;
    for ([[maybe_unused]] const EdgeEnd& e : mesh.star_of(v)) ++degree;
    return degree;
  };
  std::vector<Global> degrees(slab.vertices.count, 0);
  for (Global i = 0; i < slab.vertices.count; ++i)
    for (std::size_t s = topology.star[i]; s < topology.star[i + 1]; ++s)
      degrees[i] += topology.spokes[s].edge >= 0;
  const auto expected = fetch<Global>(world, slab.vertices, degrees, mesh.vertices.original);
  for (Local v = 0; v < mesh.vertices.owned; ++v) {
    EXPECT_EQ(degree_of(v), expected[v]);
    for (const EdgeEnd& e : mesh.star_of(v)) EXPECT_EQ(degree_of(e.other), expected[e.other]);
  }

  // Every owned vertex is in all its cells and triples.
  const auto global_uses = [&](auto&& count) {
    double uses = 0;
    count(uses);
    return sum_over(world, uses);
  };
  EXPECT_EQ(global_uses([&](double& uses) {
              for (const LocalCell& c : mesh.cells)
                for (int k = 0; k < c.size(); ++k) uses += mesh.owns_vertex(c.vertices[k]);
            }),
            global_uses([&](double& uses) {
              for (const Cell& c : slab.cell) uses += c.size();
            }));
  EXPECT_EQ(global_uses([&](double& uses) {
              for (const auto& t : mesh.triples)
                for (const Local v : t) uses += mesh.owns_vertex(v);
            }),
            3 * sum_over(world, double(topology.triples.size())));
}

} // namespace

TEST(Slab, CoversAllOnce) {
  for (const Global total : {0, 1, 5, 17, 1000})
    for (const int ranks : {1, 2, 3, 8, 40}) {
      Global next = 0;
      for (int r = 0; r < ranks; ++r) {
        const Slab s = slab_of(total, ranks, r);
        EXPECT_EQ(s.first, next);
        for (Global i = s.first; i < s.first + s.count; ++i) EXPECT_EQ(slab_rank(total, ranks, i), r);
        next += s.count;
      }
      EXPECT_EQ(next, total);
    }
}

TEST(Topology, CountsOfAGrid) {
  const Topology t = find_topology(world, make_grid(world, {1, 1}, {7, 5}));
  EXPECT_EQ(t.constrained_edges, 6 * 5 + 7 * 4);
  // Triples: along each of the 5 rows 5, along each of the 7 columns 3.
  EXPECT_EQ(sum_over(world, Global(t.triples.size())), 5 * 5 + 7 * 3);
}

TEST(Topology, LineIsOneYarn) {
  const Topology t = find_topology(world, make_line(world, 1.0, 11));
  EXPECT_EQ(t.constrained_edges, 10);
  EXPECT_EQ(sum_over(world, Global(t.triples.size())), 9);
}

TEST(Topology, YarnsEndAtIrregularVertices) {
  // Five quads around one vertex: no edge of the centre has exactly one partner.
  std::vector<Vec3> points{Vec3::Zero()};
  std::vector<Cell> cells;
  for (int k = 0; k < 10; ++k) points.emplace_back(std::cos(0.2 * M_PI * k), std::sin(0.2 * M_PI * k), 0);
  for (Global k = 0; k < 5; ++k) cells.push_back({{0, 1 + 2 * k, 2 + 2 * k, 1 + (2 * k + 2) % 10}});
  const Topology t = find_topology(world, slab_of_whole(world, points, cells));
  for (const YarnTriple& triple : t.triples) EXPECT_NE(triple.centre, 0);
}

TEST(Topology, MixedMeshConstrainsTheEdgesOfQuadsOnly) {
  const std::vector<Vec3> points{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {2, 0, 0}};
  const Topology t = find_topology(world, slab_of_whole(world, points, {{{0, 1, 2, 3}}, {{1, 4, 2, -1}}}));
  EXPECT_EQ(t.constrained_edges, 4);
}

class FaultyMesh : public testing::Test {
protected:
  static std::string message_for(const std::vector<Vec3>& points, const std::vector<Cell>& cells) {
    MeshSlab mesh = slab_of_whole(world, points, cells);
    mesh.name = "bad.obj";
    for (Global i = 0; i < mesh.vertices.count; ++i) mesh.vertex_lines.push_back(1 + mesh.vertices.first + i);
    for (Global i = 0; i < mesh.cells.count; ++i) mesh.cell_lines.push_back(101 + mesh.cells.first + i);
    try {
      find_topology(world, mesh);
    } catch (const InputError& e) {
      return e.what();
    }
    return "no error";
  }
  const std::vector<Vec3> six_{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {2, 0, 0}, {2, 1, 0}};
};

TEST_F(FaultyMesh, FlippedFace) {
  EXPECT_THAT(message_for(six_, {{{0, 1, 2, 3}}, {{1, 2, 5, 4}}}),
              testing::StartsWith(
                  "bad.obj:102: this face and the face on line 101 run along the edge between vertices "
                  "1 and 2 in the same direction"));
}

TEST_F(FaultyMesh, NonManifoldEdge) {
  EXPECT_THAT(message_for(six_, {{{0, 1, 2, 3}}, {{2, 1, 4, 5}}, {{2, 1, 3, 5}}}),
              testing::HasSubstr("has 3 faces (one on line 101): the mesh is non-manifold there"));
}

TEST_F(FaultyMesh, DoubledLine) {
  EXPECT_THAT(message_for({{0, 0, 0}, {1, 0, 0}}, {{{0, 1, -1, -1}}, {{1, 0, -1, -1}}}),
              testing::HasSubstr("bad.obj:102: the edge between vertices 0 and 1 is there twice"));
}

TEST_F(FaultyMesh, IsolatedVertex) {
  EXPECT_EQ(message_for(six_, {{{0, 1, 2, 3}}}),
            "bad.obj:5: vertex 4 belongs to no face and no line; remove it");
}

TEST_F(FaultyMesh, ZeroLengthEdge) {
  EXPECT_THAT(message_for({{0, 0, 0}, {1, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{{0, 1, 2, 3}}}),
              testing::StartsWith("bad.obj:3: vertex 2 lies exactly on vertex 1 (line 2)"));
}

namespace {

constexpr std::size_t large = std::size_t(1) << 26; ///< bytes

/// So many items in a row, of which all but the last are one piece of memory.
class ManyViews {
public:
  explicit ManyViews(std::size_t items) : bytes_(items * large), file_(memfd_create("views", 0)) {
    EXPECT_EQ(ftruncate(file_, 2 * large), 0);
    start_ = static_cast<char*>(mmap(nullptr, bytes_, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0));
    for (std::size_t k = 0; k < items; ++k)
      EXPECT_NE(mmap(start_ + k * large, large, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_FIXED, file_,
                     k + 1 < items ? 0 : off_t(large)),
                MAP_FAILED);
  }
  ~ManyViews() {
    munmap(start_, bytes_);
    close(file_);
  }
  ManyViews(const ManyViews&) = delete;
  std::span<char> all() { return {start_, bytes_}; }

private:
  std::size_t bytes_;
  int file_;
  char* start_;
};

} // namespace

// What Plan and all exchanges send by; on one rank, which sends to itself.
TEST(ItemType, CarriesMoreBytesThanAnIntCounts) {
  if (size_of(world) > 1) GTEST_SKIP();
  constexpr int items = 33;
  static_assert(items * large > std::size_t(std::numeric_limits<int>::max()));
  ManyViews source(items), target(items);
  std::ranges::fill(source.all().first(large), 'a');
  std::ranges::fill(source.all().last(large), 'b');
  const detail::ItemType item(large);
  MPI_Sendrecv(source.all().data(), items, item, 0, 0, target.all().data(), items, item, 0, 0, world,
               MPI_STATUS_IGNORE);
  EXPECT_TRUE(std::ranges::equal(target.all().first(large), source.all().first(large)));
  EXPECT_TRUE(std::ranges::equal(target.all().last(large), source.all().last(large)));
}

TEST(Distribute, GridByMetis) {
  const MeshSlab slab = make_grid(world, {2, 1}, {23, 17});
  check(slab, partition(world, slab, find_topology(world, slab), Partitioner::metis));
}

TEST(Distribute, GridByPtScotch) {
  const MeshSlab slab = make_grid(world, {2, 1}, {23, 17});
  check(slab, partition(world, slab, find_topology(world, slab), Partitioner::ptscotch));
}

TEST(Distribute, GridByStripes) {
  const MeshSlab slab = make_grid(world, {2, 1}, {23, 17});
  check(slab, partition(world, slab, find_topology(world, slab), Partitioner::stripes));
}

TEST(Distribute, RandomOwners) {
  const MeshSlab slab = make_grid(world, {2, 1}, {9, 8});
  for (unsigned seed = 0; seed < 5; ++seed) check(slab, random_owners(slab.vertices, seed));
}

TEST(Distribute, AllOnTheLastRank) {
  const MeshSlab slab = make_grid(world, {2, 1}, {9, 8});
  check(slab, std::vector<int>(slab.vertices.count, size_of(world) - 1));
}

TEST(Distribute, OneQuad) {
  const MeshSlab slab = make_grid(world, {1, 1}, {2, 2});
  for (const Partitioner method : {Partitioner::metis, Partitioner::ptscotch, Partitioner::stripes})
    check(slab, partition(world, slab, find_topology(world, slab), method));
}

TEST(Distribute, LineOfTwo) {
  const MeshSlab slab = make_line(world, 1, 2); // more ranks than vertices
  check(slab, partition(world, slab, find_topology(world, slab), Partitioner::metis));
}

TEST(Distribute, DisconnectedPieces) {
  const MeshSlab slab = two_pieces();
  for (const Partitioner method : {Partitioner::metis, Partitioner::ptscotch})
    check(slab, partition(world, slab, find_topology(world, slab), method));
}

TEST(Distribute, GraphPartitionersBalanceAndCutLittle) {
  const MeshSlab slab = make_grid(world, {1, 1}, {61, 61});
  const Topology topology = find_topology(world, slab);
  for (const Partitioner method : {Partitioner::metis, Partitioner::ptscotch}) {
    const auto report = distribute(world, slab, topology, partition(world, slab, topology, method)).report;
    EXPECT_LE(report.imbalance, 1.05);
    EXPECT_LE(report.edge_cut, 70 * (size_of(world) - 1));
  }
}

TEST(Partition, IntoMorePartsThanRanks) {
  const MeshSlab slab = make_grid(world, {1, 1}, {61, 61});
  const Topology topology = find_topology(world, slab);
  for (const Partitioner method : {Partitioner::metis, Partitioner::ptscotch, Partitioner::stripes}) {
    std::vector<double> sizes(20, 0.0);
    for (const int part : partition(world, slab, topology, method, 20)) ++sizes.at(part);
    sum_in_place(world, sizes);
    EXPECT_EQ(std::accumulate(sizes.begin(), sizes.end(), 0.0), 61 * 61);
    EXPECT_LE(*std::max_element(sizes.begin(), sizes.end()), 1.05 * 61 * 61 / 20);
  }
}

TEST(Partition, IsTheSameEachTime) {
  const MeshSlab slab = make_grid(world, {1, 1}, {61, 61});
  const Topology topology = find_topology(world, slab);
  for (const Partitioner method : {Partitioner::metis, Partitioner::ptscotch}) {
    const auto first = partition(world, slab, topology, method);
    for (int again = 0; again < 5; ++again) EXPECT_EQ(partition(world, slab, topology, method), first);
  }
}

TEST(Partition, OfAMeshSmallerThanTheRanks) {
  // Some slabs are empty here, and yet there are fewer parts than vertices.
  const MeshSlab slab = make_line(world, 1, 5);
  const Topology topology = find_topology(world, slab);
  for (const Partitioner method : {Partitioner::metis, Partitioner::ptscotch, Partitioner::stripes})
    for (const int part : partition(world, slab, topology, method, 2)) EXPECT_TRUE(part == 0 || part == 1);
}

TEST(Distribute, EdgesOfAYarnFollowEachOther) {
  const MeshSlab slab = make_grid(world, {1, 1}, {12, 9});
  const Topology topology = find_topology(world, slab);
  const DistributedMesh mesh = distribute(world, slab, topology, std::vector<int>(slab.vertices.count, 0));
  Local breaks = 0;
  for (Local e = 1; e < mesh.edges.owned; ++e) {
    const auto &a = mesh.edge_vertices[e - 1], &b = mesh.edge_vertices[e];
    breaks += a[0] != b[0] && a[0] != b[1] && a[1] != b[0] && a[1] != b[1];
  }
  EXPECT_LE(breaks, 12 + 9);
}
