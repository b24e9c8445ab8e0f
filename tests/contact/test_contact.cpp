// Contact below the time step: closest points, conservative advancement, the search against brute force.
#include "src/contact/contact_search.hpp"
#include "src/contact/intersections.hpp"
#include "src/contact/obstacle_surface.hpp"
#include "src/contact/safe_iterate.hpp"
#include "tests/folder.hpp"
#include "tests/simulate.hpp"

#include <gmock/gmock.h>

#include <Eigen/Geometry>

#include <fstream>
#include <set>

namespace taut::test {
namespace {

Four random_four(unsigned seed, double size = 1.0) {
  const auto v = random_vectors(4, size, seed);
  return {v[0], v[1], v[2], v[3]};
}

/// The distance by trying many points of both features.
double sampled_distance(PairKind kind, const Four& x, int n) {
  double least = HUGE_VAL;
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j <= (kind == PairKind::edge_edge ? n : n - i); ++j) {
      const double s = double(i) / n, t = double(j) / n;
      const Vec3 offset = kind == PairKind::edge_edge
                              ? Vec3((1 - s) * x[0] + s * x[1] - (1 - t) * x[2] - t * x[3])
                              : Vec3(x[0] - (1 - s - t) * x[1] - s * x[2] - t * x[3]);
      least = std::min(least, offset.norm());
    }
  return least;
}

TEST(Closest, IsNoFartherThanAnySampledPoints) {
  for (unsigned seed = 0; seed < 300; ++seed) {
    const Four x = random_four(seed);
    for (const PairKind kind : {PairKind::vertex_face, PairKind::edge_edge}) {
      const Closest c = kind == PairKind::vertex_face ? closest_vertex_face(x) : closest_edge_edge(x);
      const double sampled = sampled_distance(kind, x, 60);
      EXPECT_LE(c.distance, sampled + 1e-12) << seed;
      EXPECT_GE(c.distance, sampled - 0.06) << seed;
      EXPECT_NEAR(c.weights[0] + c.weights[1] + c.weights[2] + c.weights[3], 0.0, 1e-12);
      EXPECT_NEAR(c.offset.norm(), c.distance, 1e-15);
    }
  }
}

TEST(Closest, ParallelAndDegenerateEdgesHaveADistance) {
  const Vec3 o(0, 0, 0), x(1, 0, 0), y(0, 1, 0), xy(1, 1, 0), far(3, 4, 0);
  EXPECT_DOUBLE_EQ(closest_edge_edge({o, x, y, xy}).distance, 1.0);
  EXPECT_DOUBLE_EQ(closest_edge_edge({o, x, xy, y}).distance, 1.0);
  EXPECT_DOUBLE_EQ(closest_edge_edge({o, o, y, xy}).distance, 1.0);
  EXPECT_DOUBLE_EQ(closest_edge_edge({o, x, y, y}).distance, 1.0);
  EXPECT_DOUBLE_EQ(closest_edge_edge({o, o, far, far}).distance, 5.0);
}

Pair pair_of(PairKind kind) { return {{0, 1, 2, 3}, kind, -1, 0.0, Vec3::UnitZ()}; }

Four moved(const Four& x, const Four& u, double t) {
  Four y;
  for (int i = 0; i < 4; ++i) y[i] = x[i] + t * u[i];
  return y;
}

TEST(Advance, KeepsTheFloorAndDoesNotStopForNothing) {
  int stopped = 0, arrived = 0;
  for (unsigned seed = 0; seed < 400; ++seed)
    for (const PairKind kind : {PairKind::vertex_face, PairKind::edge_edge, PairKind::vertex_plane}) {
      const Pair pair = pair_of(kind);
      const Four x = random_four(seed), u = random_four(seed + 1000, 2.0);
      const double gap = approach(pair, x).gap, floor = 0.2 * gap;
      if (gap <= 0) continue;
      const double part = safe_fraction(pair, x, u, floor);
      double least = gap;
      for (int k = 0; k <= 200; ++k) least = std::min(least, approach(pair, moved(x, u, part * k / 200)).gap);
      EXPECT_GE(least, floor - 1e-12) << seed;
      double least_of_all = gap;
      for (int k = 0; k <= 2000; ++k)
        least_of_all = std::min(least_of_all, approach(pair, moved(x, u, k / 2000.0)).gap);
      if (least_of_all > 1.1 * floor) {
        EXPECT_EQ(part, 1.0) << seed;
      }
      ++(part < 1 ? stopped : arrived);
    }
  EXPECT_GT(stopped, 100);
  EXPECT_GT(arrived, 100);
}

constexpr double no_number = std::numeric_limits<double>::quiet_NaN();

TEST(Advance, StandsStillWhereSomethingIsNotANumber) {
  for (const PairKind kind : {PairKind::vertex_face, PairKind::edge_edge, PairKind::vertex_edge})
    for (unsigned seed = 0; seed < 20; ++seed)
      for (int i = 0; i < (kind == PairKind::vertex_edge ? 3 : 4); ++i)
        for (const double bad : {no_number, HUGE_VAL}) {
          const Four x = random_four(seed), u = random_four(seed + 1000, 1e-3);
          Four no_place = x, no_motion = u;
          no_place[i][seed % 3] = no_motion[i][seed % 3] = bad;
          EXPECT_EQ(safe_fraction(pair_of(kind), no_place, u, 1e-6), 0.0) << int(kind) << seed << i;
          EXPECT_EQ(safe_fraction(pair_of(kind), x, no_motion, 1e-6), 0.0) << int(kind) << seed << i;
        }
}

Case crumpled_case() {
  return case_of("cloth: {grid: {size: [1, 1], vertices: [8, 7]}}\n"
                 "contact: {thickness: 0.01}\n"
                 "obstacles:\n"
                 "  - sphere: {centre: [0.3, 0.3, 0.2], radius: 0.1}\n"
                 "  - capsule: {from: [0, 0.5, 0.3], to: [1, 0.6, 0.3], radius: 0.05}\n"
                 "  - box: {min: [0.6, 0.1, -0.2], max: [0.9, 0.4, 0.1]}\n"
                 "  - plane: {point: [0, 0, -0.3]}\n");
}

using Name = std::vector<Global>;
Name unordered_name(const Pair& pair, std::span<const Global> keys) {
  Name name{Global(pair.kind)};
  for (const Local v : pair.vertices) name.push_back(keys[v]);
  auto sort = [&](int from, int to) { std::sort(name.begin() + from, name.begin() + to); };
  if (pair.kind == PairKind::vertex_face) sort(2, 5);
  if (pair.kind == PairKind::edge_edge) {
    sort(1, 3);
    sort(3, 5);
    if (std::pair(name[3], name[4]) < std::pair(name[1], name[2])) {
      std::swap(name[1], name[3]);
      std::swap(name[2], name[4]);
    }
  }
  return name;
}

/// Random positions and ends of a motion, of the whole cloth.
struct Crumpled {
  Case input = crumpled_case();
  Cloth cloth;
  Obstacles obstacles;
  std::vector<Vec3> from, to, bodies;

  Crumpled(DistributedMesh mesh, unsigned seed)
      : cloth(make_cloth(std::move(mesh), input.cloths[0].material)), obstacles(cloth.mesh.comm, input) {
    const auto place = random_vectors(56, 0.5, seed), motion = random_vectors(56, 0.05, seed + 1);
    for (const Global v : cloth.mesh.vertices.original) {
      from.emplace_back(place[v] + Vec3(0.5, 0.5, 0.2));
      to.emplace_back(from.back() + motion[v]);
    }
    obstacles.place(0, bodies);
  }
  Motion motion() const { return {from, to, bodies, bodies}; }
};

MeshSlab crumpled_mesh(MPI_Comm comm) { return make_grid(comm, {1, 1}, {8, 7}); }

/// All pairs of a search, over all ranks.
std::multiset<Name> everybodys_pairs(const Cloth& cloth, const ContactSearch& search) {
  std::vector<Global> flat;
  for (const Pair& p : search.pairs()) {
    const Name name = unordered_name(p, search.keys());
    flat.insert(flat.end(), name.begin(), name.end());
  }
  std::vector<Global> all;
  std::vector<int> destinations;
  std::vector<Global> copies;
  for (int r = 0; r < size_of(cloth.mesh.comm); ++r) {
    copies.insert(copies.end(), flat.begin(), flat.end());
    destinations.insert(destinations.end(), flat.size(), r);
  }
  all = exchange(cloth.mesh.comm, copies, destinations).items;
  std::multiset<Name> names;
  for (std::size_t i = 0; i < all.size(); i += 5) names.insert(Name(all.begin() + i, all.begin() + i + 5));
  return names;
}

TEST(ContactSearch, FindsTheSamePairsOnceOnAnyPartition) {
  Crumpled whole(serial(crumpled_mesh), 3);
  ContactSearch serial_search(whole.cloth, whole.obstacles);
  serial_search.find(whole.motion(), 0.022);
  const auto expected = everybodys_pairs(whole.cloth, serial_search);
  EXPECT_GT(expected.size(), 500u);
  on_odd_partitions(crumpled_mesh, [&](DistributedMesh mesh) {
    Crumpled part(std::move(mesh), 3);
    ContactSearch search(part.cloth, part.obstacles);
    search.find(part.motion(), 0.022);
    EXPECT_EQ(everybodys_pairs(part.cloth, search), expected);
  });
}

/// Every triangle of the grid, cut as the surface is, and every edge.
struct Features {
  std::vector<std::array<Global, 3>> faces;
  std::set<std::array<Global, 2>> edges;

  Features() {
    const MeshSlab slab = crumpled_mesh(self);
    for (const Cell& c : slab.cell) {
      const auto& v = c.vertices;
      faces.push_back({v[0], v[1], v[2]});
      faces.push_back({v[0], v[2], v[3]});
    }
    for (const auto& f : faces)
      for (int k = 0; k < 3; ++k)
        edges.insert({std::min(f[k], f[(k + 1) % 3]), std::max(f[k], f[(k + 1) % 3])});
  }
};

/// Expects every pair of features of the cloth that comes within `reach` on the way to be among `found`;
/// returns how many do. Positions of all vertices, in input order.
int expect_what_comes_near(std::span<const Vec3> from, std::span<const Vec3> to, double reach,
                           const std::multiset<Name>& found) {
  const auto comes_near = [&](const Pair& pair, const std::array<Global, 4>& v) {
    const Four x{from[v[0]], from[v[1]], from[v[2]], from[v[3]]}, y{to[v[0]], to[v[1]], to[v[2]], to[v[3]]};
    Four u;
    for (int i = 0; i < 4; ++i) u[i] = y[i] - x[i];
    for (int k = 0; k <= 50; ++k)
      if (approach(pair, moved(x, u, k / 50.0)).gap < reach) return true;
    return false;
  };
  const Features features;
  int expected = 0;
  const auto expect = [&](const Pair& pair, const std::array<Global, 4>& v) {
    if (!comes_near(pair, v)) return;
    ++expected;
    const Pair by_key{{0, 1, 2, 3}, pair.kind, -1, 0, Vec3::Zero()};
    EXPECT_EQ(found.count(unordered_name(by_key, v)), 1u);
  };
  for (Global p = 0; p < Global(from.size()); ++p)
    for (const auto& f : features.faces)
      if (std::find(f.begin(), f.end(), p) == f.end())
        expect(pair_of(PairKind::vertex_face), {p, f[0], f[1], f[2]});
  for (const auto& e : features.edges)
    for (const auto& g : features.edges)
      if (e < g && e[0] != g[0] && e[0] != g[1] && e[1] != g[0] && e[1] != g[1])
        expect(pair_of(PairKind::edge_edge), {e[0], e[1], g[0], g[1]});
  return expected;
}

/// What all ranks hold of their vertices, in input order.
std::vector<Vec3> in_input_order(const Cloth& cloth, std::span<const Vec3> values) {
  std::vector<Vec3> all(56, Vec3::Zero());
  for (Local i = 0; i < cloth.mesh.vertices.owned; ++i) all[cloth.mesh.vertices.original[i]] = values[i];
  MPI_Allreduce(MPI_IN_PLACE, all.data(), 3 * 56, MPI_DOUBLE, MPI_SUM, cloth.mesh.comm);
  return all;
}

TEST(ContactSearch, FindsWhatBruteForceFinds) {
  Crumpled whole(serial(crumpled_mesh), 5);
  const double reach = 0.02;
  ContactSearch search(whole.cloth, whole.obstacles);
  search.find(whole.motion(), reach);
  EXPECT_GT(expect_what_comes_near(in_input_order(whole.cloth, whole.from),
                                   in_input_order(whole.cloth, whole.to), reach,
                                   everybodys_pairs(whole.cloth, search)),
            200);
}

/// A target that strays from where the search took it to end, every third vertex more and more; the others do
/// not. Some stay within the slack, some within what is added to it, some go beyond that too.
TEST(ContactSearch, FollowsWhereverTheTargetStrays) {
  constexpr double reach = 0.01, slack = 0.01;
  const auto astray = random_vectors(56, 0.03, 11);
  on_odd_partitions(crumpled_mesh, [&](DistributedMesh mesh) {
    Crumpled part(std::move(mesh), 7);
    std::vector<Vec3> there = part.to;
    ContactSearch search(part.cloth, part.obstacles);
    search.find({part.from, part.to, part.bodies, part.bodies}, reach, slack);
    for (const double part_of_way : {0.2, 0.6, 0.8, 1.0, 2.0}) {
      for (std::size_t i = 0; i < there.size(); ++i) {
        const Global v = part.cloth.mesh.vertices.original[i];
        if (v % 3 == 0) there[i] = part.to[i] + part_of_way * astray[v];
      }
      EXPECT_TRUE(search.follow({part.from, there, part.bodies, part.bodies}));
      const auto found = everybodys_pairs(part.cloth, search);
      EXPECT_EQ(std::set<Name>(found.begin(), found.end()).size(), found.size()); // each once
      EXPECT_GT(expect_what_comes_near(in_input_order(part.cloth, part.from),
                                       in_input_order(part.cloth, there), reach, found),
                100);
      search.follow({part.from, there, part.bodies, part.bodies});
      EXPECT_EQ(everybodys_pairs(part.cloth, search), found);
    }
  });
}

std::vector<Name> pairs_in_order(const ContactSearch& search) {
  std::vector<Name> names;
  for (const Pair& p : search.pairs()) names.push_back(unordered_name(p, search.keys()));
  return names;
}

/// Steps of one run: small ones and a large one, a fall of all, one step done again, a start elsewhere.
TEST(ContactSearch, KeepsWhatItKnowsFromStepToStep) {
  constexpr double reach = 0.01, slack = 0.01;
  on_odd_partitions(crumpled_mesh, [&](DistributedMesh mesh) {
    Crumpled part(std::move(mesh), 7);
    const std::vector<Global>& vertices = part.cloth.mesh.vertices.original;
    ContactSearch search(part.cloth, part.obstacles);
    const auto expect_all = [&](std::span<const Vec3> from, std::span<const Vec3> to) {
      const Motion motion{from, to, part.bodies, part.bodies};
      search.find(motion, reach, slack);
      const auto found = everybodys_pairs(part.cloth, search);
      EXPECT_EQ(std::set<Name>(found.begin(), found.end()).size(), found.size()); // each once
      EXPECT_GT(expect_what_comes_near(in_input_order(part.cloth, from), in_input_order(part.cloth, to),
                                       reach, found),
                100);
      ContactSearch anew(part.cloth, part.obstacles);
      anew.find(motion, reach, slack);
      EXPECT_EQ(pairs_in_order(anew), pairs_in_order(search));
    };
    unsigned seed = 20;
    for (const auto& [length, fall] : {std::pair{0.001, 0.0},
                                       {0.001, 0.0},
                                       {0.001, 0.2},
                                       {0.004, 0.0},
                                       {0.05, 0.0},
                                       {0.002, 0.0},
                                       {0.004, 0.0},
                                       {0.004, 0.0}}) {
      const auto motion = random_vectors(56, length, ++seed);
      std::vector<Vec3> to = part.from;
      for (std::size_t i = 0; i < to.size(); ++i) to[i] += motion[vertices[i]] - fall * Vec3::UnitZ();
      expect_all(part.from, to);
      if (length == 0.004) // halved
        for (std::size_t i = 0; i < to.size(); ++i) to[i] = 0.5 * (part.from[i] + to[i]);
      expect_all(part.from, to);
      part.from = to;
    }
  });
}

TEST(SafeIterate, DoesNotGoWhereSomethingIsNotANumber) {
  on_odd_partitions(crumpled_mesh, [&](DistributedMesh mesh) {
    Crumpled part(std::move(mesh), 7);
    const std::vector<Global>& vertices = part.cloth.mesh.vertices.original;
    const Thickness thickness(part.cloth, part.input);
    ContactScene scene(part.cloth, part.obstacles);
    SafeIterate safe(scene, thickness);
    State start;
    start.positions.resize(vertices.size());
    for (std::size_t i = 0; i < vertices.size(); ++i) // flat, and far from everything
      start.positions[i] = Vec3(double(vertices[i] % 8) / 7, double(vertices[i] / 8) / 6, 2);
    scene.begin(start, 0.01);
    safe.begin();
    scene.search.find(safe.motion(), thickness.largest_near());
    scene.gather_start();
    safe.keep_pairs(0);
    safe.measure_gaps(0);
    EXPECT_EQ(safe.safe_fraction_to_target(), 1.0);
    for (std::size_t i = 0; i < vertices.size(); ++i)
      if (vertices[i] == 17) scene.target.cloth[i][1] = no_number;
    EXPECT_EQ(safe.safe_fraction_to_target(), 0.0);
  });
}

TEST(Intersections, AreCountedAlikeOnAnyPartition) {
  Crumpled whole(serial(crumpled_mesh), 7);
  const auto count = [](const Crumpled& c) {
    Intersections test(c.cloth, c.obstacles);
    return sum_over(c.cloth.mesh.comm, Global(test.find(c.from, c.bodies).size()));
  };
  const Global expected = count(whole);
  EXPECT_GT(expected, 100);
  on_odd_partitions(crumpled_mesh,
                    [&](DistributedMesh mesh) { EXPECT_EQ(count(Crumpled(std::move(mesh), 7)), expected); });
}

/// An independent count: an edge meets a face where the signs of the volumes say so.
TEST(Intersections, AgreeWithSignsOfVolumes) {
  Crumpled whole(serial(crumpled_mesh), 9);
  Case nothing = crumpled_case();
  nothing.obstacles.clear();
  const Obstacles none(self, nothing);
  Intersections test(whole.cloth, none);
  std::vector<Vec3> x(56);
  for (Local i = 0; i < 56; ++i) x[whole.cloth.mesh.vertices.original[i]] = whole.from[i];
  const auto volume = [&](Global a, Global b, Global c, Global d) {
    return (x[b] - x[a]).cross(x[c] - x[a]).dot(x[d] - x[a]);
  };
  Global expected = 0;
  const Features features;
  for (const auto& [a, b] : features.edges)
    for (const auto& [p, q, r] : features.faces) {
      if (std::set<Global>{a, b, p, q, r}.size() < 5) continue;
      const bool crosses = volume(p, q, r, a) * volume(p, q, r, b) < 0;
      const double s1 = volume(a, b, p, q), s2 = volume(a, b, q, r), s3 = volume(a, b, r, p);
      expected += crosses && ((s1 > 0 && s2 > 0 && s3 > 0) || (s1 < 0 && s2 < 0 && s3 < 0));
    }
  EXPECT_EQ(Global(test.find(whole.from, {}).size()), expected);
  EXPECT_GT(expected, 100);
}

TEST(Obstacles, FollowTheirSequenceOfMeshes) {
  const Folder folder;
  if (rank_of(world) == 0)
    for (const auto& [name, z] : {std::pair{"body_09.obj", 0.0}, {"body_10.obj", 1.0}, {"body_11.obj", 3.0}})
      std::ofstream(folder / name) << "v 0 0 " << z << "\nv 1 0 " << z << "\nv 0 1 " << z << "\nf 1 2 3\n";
  MPI_Barrier(world);
  const Case input = read_case("cloth: {grid: {size: [1, 1], vertices: [3, 3]}}\n"
                               "obstacles:\n"
                               "  - mesh: body_09.obj\n"
                               "    sequence: {fps: 10, frames: 3}\n"
                               "    motion: [{time: 0}, {time: 1, translate: [2, 0, 0]}]\n",
                               folder / "case.yaml");
  const Obstacles obstacles(world, input);
  ASSERT_EQ(obstacles.vertices(), 3);
  EXPECT_EQ(obstacles.body(0).rims, 3);
  const ObstacleSurface shown(obstacles, 1.0);
  for (const auto& [time, z] :
       {std::pair{0.0, 0.0}, {0.05, 0.5}, {0.1, 1.0}, {0.15, 2.0}, {0.2, 3.0}, {0.7, 3.0}}) {
    std::vector<Vec3> at;
    obstacles.place(time, at);
    EXPECT_LT((at[1] - Vec3(1 + 2 * time, 0, z)).norm(), 1e-12) << time;
    EXPECT_EQ(at, shown.at(time));
  }
}

} // namespace
} // namespace taut::test
