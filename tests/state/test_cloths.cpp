// Several cloths in one case: their meshes joined, each with its own material.
#include "partition/grid.hpp"
#include "partition/join.hpp"
#include "src/contact/thickness.hpp"
#include "src/state/start.hpp"
#include "tests/folder.hpp"
#include "tests/garment/patterns.hpp"
#include "tests/simulate.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

using namespace taut;
using namespace taut::test;

namespace {

ListedMesh listed(const MeshSlab& slab) { return {slab, find_topology(world, slab)}; }

/// The meshes one behind the other, from what every rank knows of all.
MeshSlab whole_of(const std::vector<MeshSlab>& meshes) {
  std::vector<Vec3> points;
  std::vector<Cell> cells;
  for (const MeshSlab& m : meshes) {
    for (Cell c : m.cell) {
      for (Global& v : c.vertices)
        if (v >= 0) v += Global(points.size());
      cells.push_back(c);
    }
    points.insert(points.end(), m.rest_positions.begin(), m.rest_positions.end());
  }
  return slab_of_whole(world, points, cells);
}

auto as_tuple(const Spoke& s) { return std::tuple(s.centre, s.neighbour, s.edge, s.cells); }
auto as_tuple(const EdgeFaces& h) { return std::tuple(h.low, h.high, h.left, h.right, h.cells); }

template<class T>
auto tuples(const std::vector<T>& items) {
  std::vector<decltype(as_tuple(items[0]))> result;
  for (const T& i : items) result.push_back(as_tuple(i));
  return result;
}

void expect_same(const Topology& a, const Topology& b) {
  EXPECT_EQ(a.triangles_only, b.triangles_only);
  EXPECT_EQ(a.constrained_edges, b.constrained_edges);
  EXPECT_EQ(tuples(a.spokes), tuples(b.spokes));
  EXPECT_EQ(a.star, b.star);
  EXPECT_EQ(a.triples, b.triples);
  EXPECT_EQ(tuples(a.hinges), tuples(b.hinges));
}

const std::string two_strips = R"(
cloths:
  - {name: soft, grid: {size: [0.4, 0.1], vertices: [9, 3]},
     material: {density: 0.2, bending: 1e-4, shear: 5, stretch: 200, damping: {mass: 0.3}}}
  - {name: stiff, grid: {size: [0.4, 0.1], vertices: [9, 3]}, start: {translate: [0, 1, 0]},
     material: {density: 0.35, bending: 4e-3, bending_model: MODEL, shear: 20, shear_model: diagonals, stretch: 500,
                damping: {stiffness: 1e-3}}}
pins: [{cloth: soft, box: {min: [-1, -1, -1], max: [0.06, 3, 1]}}, {cloth: 1, vertices: [0, 1, 9, 10, 18, 19]}]
REST
)";
const std::string rest = R"(
velocity: {solver: mumps}
inextensibility: {method: none}
time: {end: 0.3, frame_rate: 10, max_step: 0.005}
)";

std::string with_model(std::string text, const std::string& model) {
  text.replace(text.find("MODEL"), 5, model);
  text.replace(text.find("REST"), 4, rest);
  return text;
}

/// One of the two strips in a case of its own.
Case alone(const Case& both, int k) {
  Case input = both;
  input.cloths = {both.cloths[k]};
  input.pins = {both.pins[k]};
  input.pins[0].cloth.reset();
  return input;
}

std::vector<Column> positions_of(const Case& input) {
  Simulation simulation(world, input);
  Recorder recorder(simulation);
  run_to_the_end(simulation, recorder);
  return recorder.positions;
}

} // namespace

TEST(Cloths, JoinedMeshesAreTheWholeMesh) {
  const std::vector<MeshSlab> wholes{make_grid(self, {1, 1}, {4, 3}), make_line(self, 1, 5),
                                     make_grid(self, {2, 1}, {3, 6})};
  const ListedMesh meshes[] = {listed(make_grid(world, {1, 1}, {4, 3})), listed(make_line(world, 1, 5)),
                               listed(make_grid(world, {2, 1}, {3, 6}))};
  const MeshSlab expected = whole_of(wholes);
  const ListedMesh joined = join(world, meshes);
  EXPECT_EQ(joined.slab.vertices.first, expected.vertices.first);
  EXPECT_EQ(joined.slab.vertices.count, expected.vertices.count);
  EXPECT_EQ(joined.slab.cells.count, expected.cells.count);
  EXPECT_EQ(joined.slab.rest_positions, expected.rest_positions);
  ASSERT_EQ(joined.slab.cell.size(), expected.cell.size());
  for (std::size_t c = 0; c < expected.cell.size(); ++c)
    EXPECT_EQ(joined.slab.cell[c].vertices, expected.cell[c].vertices);
  EXPECT_TRUE(joined.slab.texture.empty());
  expect_same(joined.topology, find_topology(world, expected));
}

TEST(Cloths, TextureIsKeptBesideAMeshWithout) {
  MeshSlab textured = make_grid(world, {1, 1}, {4, 4});
  for (Global c = 0; c < textured.cells.count; ++c) {
    const double number = double(textured.cells.first + c);
    textured.texture.push_back({Vec2(number, 0), Vec2(number, 1), Vec2(number, 2), Vec2(number, 3)});
  }
  const ListedMesh meshes[] = {listed(make_grid(world, {1, 1}, {3, 3})), listed(textured)};
  const MeshSlab joined = join(world, meshes).slab;
  ASSERT_EQ(joined.texture.size(), joined.cell.size());
  for (Global c = 0; c < joined.cells.count; ++c) {
    const Global number = joined.cells.first + c;
    EXPECT_EQ(joined.texture[c][2], number < 4 ? Vec2(0, 0) : Vec2(double(number - 4), 2));
  }
}

TEST(Cloths, TrianglesBesideQuadsKeepAllTheirEdges) {
  const auto triangles = [](MPI_Comm comm) { return make_grid(comm, {1, 1}, {4, 4}, GridCells::triangles); };
  const ListedMesh meshes[] = {listed(make_grid(world, {1, 1}, {4, 4})), listed(triangles(world))};
  const ListedMesh joined = join(world, meshes);
  EXPECT_FALSE(joined.topology.triangles_only);
  EXPECT_EQ(joined.topology.constrained_edges,
            meshes[0].topology.constrained_edges + meshes[1].topology.constrained_edges);
  for (const Spoke& s : joined.topology.spokes) EXPECT_GE(s.edge, 0);
  const ListedMesh alone[] = {meshes[1], meshes[1]};
  EXPECT_TRUE(join(world, alone).topology.triangles_only);
}

TEST(Cloths, EachMovesAsItDoesAlone) {
  for (const char* model : {"yarn", "isometric", "baraff_witkin"}) {
    const Case both = case_of(with_model(two_strips, model));
    const auto together = positions_of(both);
    const auto soft = positions_of(alone(both, 0)), stiff = positions_of(alone(both, 1));
    ASSERT_EQ(together.size(), soft.size());
    ASSERT_EQ(together.size(), stiff.size());
    const auto n = soft[0].size();
    for (std::size_t step = 0; step < together.size(); ++step) {
      EXPECT_LT((together[step].head(n) - soft[step]).cwiseAbs().maxCoeff(), 1e-12) << model;
      EXPECT_LT((together[step].tail(n) - stiff[step]).cwiseAbs().maxCoeff(), 1e-12) << model;
    }
    EXPECT_GT((soft.back() - soft.front()).cwiseAbs().maxCoeff(), 0.05);
    const Column moved_apart = Column::Zero(n) + soft.back() - stiff.back();
    EXPECT_GT((moved_apart - (soft.front() - stiff.front())).cwiseAbs().maxCoeff(), 0.01);
  }
}

TEST(Cloths, EnergiesOfOneNameAreOne) {
  Simulation simulation(world, case_of(with_model(two_strips, "isometric")));
  Recorder recorder(simulation);
  run_to_the_end(simulation, recorder);
  // gravity, bending (of yarns and of folds), twist, shear (by angles and by diagonals), stretch
  EXPECT_EQ(recorder.records.back().energies.potential.size(), 5u);
}

TEST(Cloths, MassesAreOfTheirMaterial) {
  const Case both = case_of(with_model(two_strips, "yarn"));
  const Cloth cloth = load_cloth(world, both);
  ASSERT_EQ(cloth.pieces.size(), 2u);
  std::array<double, 2> mass{};
  for (Local i = 0; i < cloth.mesh.vertices.owned; ++i) mass[cloth.piece_of(i)] += cloth.mass[i];
  sum_in_place(world, mass);
  EXPECT_NEAR(mass[0], 0.2 * 0.04, 1e-15);
  EXPECT_NEAR(mass[1], 0.35 * 0.04, 1e-15);
}

// Two panels that are not sewn are as two cloths.
TEST(Cloths, PanelsAreOfTheirOwnMaterialAndEdges) {
  const Folder folder;
  const std::string a = rectangle("a", 0.2, 0.3),
                    b = rectangle("b", 0.3, 0.2, "    translation: [0, 1, 0]\n");
  on_rank_0(world, [&] {
    for (const auto& [name, panels] : {std::pair("a", a), std::pair("b", b), std::pair("both", a + b)})
      std::ofstream(folder / (name + std::string(".yaml"))) << "panels:\n" << panels;
  });
  MPI_Barrier(world);
  const auto pattern = [&](const char* name) {
    return fmt::format("pattern: {}, edge: 5 cm", (folder / name).string());
  };
  const std::string
      stiff = "density: 0.4, bending: 2e-3, bending_weft: 1e-3, twist: 5e-4, shear: 40, stretch: 900",
      others = "pins: [{box: {min: [-1, -1, 0.18], max: [1, 1, 3]}}]\n"
               "velocity: {solver: mumps}\ninextensibility: {method: none}\n"
               "time: {end: 0.2, frame_rate: 10, max_step: 0.01}\n";
  const std::string soft = "material: {density: 0.1, bending: 1e-5, shear: 5, stretch: 300}";
  const auto one = positions_of(
      case_of(fmt::format("cloth: {{{}, {}, panels: {{b: {{edge: 2 cm, material: {{{}}}}}}}}}\n{}",
                          pattern("both.yaml"), soft, stiff, others)));
  const auto two = positions_of(case_of(
      fmt::format("cloths: [{{{}, {}}}, {{{}, material: {{{}}}}}]\n{}", pattern("a.yaml"), soft,
                  fmt::format("pattern: {}, edge: 2 cm", (folder / "b.yaml").string()), stiff, others)));
  ASSERT_EQ(one.size(), two.size());
  for (std::size_t k = 0; k < one.size(); ++k) EXPECT_LE((one[k] - two[k]).lpNorm<Eigen::Infinity>(), 1e-9);
}

TEST(Cloths, PanelsThatAreNotThereAreNamed) {
  const Folder folder;
  on_rank_0(world, [&] { std::ofstream(folder / "a.yaml") << "panels:\n" << rectangle("collar", 0.2, 0.3); });
  MPI_Barrier(world);
  const auto message = [&](const std::string& panel) -> std::string {
    try {
      load_cloth(world, case_of(fmt::format("cloth: {{pattern: {}, edge: 5 cm, panels: {{{}}}}}",
                                            (folder / "a.yaml").string(), panel)));
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  };
  for (const char* panel : {"colar: {fabric: denim}", "colar: {edge: 3 cm}"})
    EXPECT_THAT(message(panel), testing::HasSubstr("(did you mean 'collar'?)"));
  EXPECT_EQ(message("collar: {edge: 3 cm, fabric: denim}"), "no error");
}

TEST(Cloths, PinsCountWithinTheirCloth) {
  const std::string cloths = R"(
cloths:
  - {name: lower, grid: {size: [1, 1], vertices: [3, 3]}}
  - {name: upper, grid: {size: [1, 1], vertices: [3, 3]}, start: {translate: [0, 0, 0.1]}}
)";
  const auto pinned = [&](const std::string& pins) {
    const Simulation simulation(world, case_of(cloths + "pins: " + pins));
    const IndexMap& map = simulation.cloth().mesh.vertices;
    Freedom freedom(map.size());
    auto velocities = simulation.state().velocities;
    simulation.pins().prescribe(simulation.state(), 0.01, freedom, velocities);
    std::vector<double> held(map.total, 0.0);
    for (Local i = 0; i < map.owned; ++i) held[map.original[i]] = freedom.is_held(i);
    sum_in_place(world, held);
    std::vector<int> numbers;
    for (int v = 0; v < int(held.size()); ++v)
      if (held[v] > 0) numbers.push_back(v);
    return numbers;
  };
  using testing::ElementsAre;
  EXPECT_THAT(pinned("[{cloth: upper, vertices: [0, 2]}]"), ElementsAre(9, 11));
  EXPECT_THAT(pinned("[{vertices: [0, 11]}]"), ElementsAre(0, 11));
  EXPECT_THAT(pinned("[{cloth: 1, range: [7, 8]}]"), ElementsAre(16, 17));
  EXPECT_THAT(pinned("[{cloth: upper, near: [[0, 0, 0]]}, {near: [[1, 0, 0]]}]"), ElementsAre(2, 9));
  EXPECT_THAT(pinned("[{cloth: lower, box: {min: [-1, -1, -1], max: [0.1, 0.1, 1]}}]"), ElementsAre(0));
  EXPECT_THROW(pinned("[{cloth: lower, vertices: [9]}]"), InputError);
}

namespace {

/// A cloth of 1 mm on a floor, one of 3 mm over it.
const std::string stack = R"(
cloths:
  - {grid: {size: [0.2, 0.2], vertices: [5, 5]}, start: {translate: [0, 0, 0.0012]}, thickness: 1 mm}
  - {grid: {size: [0.2, 0.2], vertices: [6, 6]}, start: {translate: [0, 0, 0.0036]}, thickness: 3 mm}
obstacles: [{plane: {}, thickness: 0.2 mm}]
contact: {check: step}
time: {end: 0.1, frame_rate: 10, max_step: 0.005}
)";

} // namespace

TEST(Cloths, ThicknessIsTheMeanOfBoth) {
  const Case input = case_of(stack);
  const Cloth cloth = load_cloth(world, input);
  const Thickness thickness(cloth, input);
  EXPECT_EQ(thickness.largest(), 0.003);
  EXPECT_EQ(thickness.smallest(), 0.001);
  const std::vector<Global> keys{0, 24, 25, 60, 61, 70}; // two of each cloth, two of the floor
  const auto of = [&](Local first, Local second) {
    return thickness.of({{first, second, second, second}, PairKind::vertex_face, -1, 0.0, Vec3::Zero()},
                        keys);
  };
  EXPECT_EQ(of(0, 1), 0.001);
  EXPECT_EQ(of(2, 3), 0.003);
  EXPECT_EQ(of(0, 2), 0.002);
  EXPECT_EQ(of(3, 1), 0.002);
  EXPECT_EQ(of(0, 4), 0.001);
  EXPECT_EQ(of(5, 3), 0.003);
}

TEST(Cloths, LieOnEachOtherAtTheirThickness) {
  using config::ContactModel;
  for (const auto& [model, tolerance] :
       {std::pair{ContactModel::constraint, 5e-5}, std::pair{ContactModel::penalty, 3e-4}}) {
    Case input = case_of(stack);
    input.contact->model = model;
    Simulation simulation(world, input);
    Recorder recorder(simulation);
    run_to_the_end(simulation, recorder);
    const Column x = recorder.positions.back();
    double lower = 0, upper = 0;
    for (int i = 0; i < 25; ++i) lower += x[3 * i + 2] / 25;
    for (int i = 25; i < 61; ++i) upper += x[3 * i + 2] / 36;
    EXPECT_NEAR(lower, 0.0012, tolerance); // its own thickness and that of the floor
    EXPECT_NEAR(upper - lower, 0.002, tolerance);
  }
}
