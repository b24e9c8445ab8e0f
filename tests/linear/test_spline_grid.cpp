#include "src/linear/pattern.hpp"
#include "src/linear/spline_grid.hpp"
#include "tests/simulate.hpp"

#include <fmt/format.h>

using namespace taut;
using namespace taut::test;

namespace {

// Spacings in m: the mixed mesh is 0.1 m thick, its edges are about 0.25 m long.
constexpr double flat = 1.0, in_space = 0.15, close = 0.03; // the last: cells couple to more than 255 nodes

/// A matrix of any entries, symmetric, by original numbers.
double entry(Global i, Global j) { return 1.0 / double(1 + i + j) + (i == j ? 2.0 : 0.0); }

bool is_held(Global vertex) { return vertex % 5 == 2; }

/// A grid for the entries on this rank's pattern, and what it does, as whole matrices.
struct Bench {
  explicit Bench(DistributedMesh m, double spacing)
      : mesh(std::move(m)), pattern(mesh), grid(world, pattern.sparse_rows(), mesh.rest_positions, spacing) {
    const auto& original = mesh.vertices.original;
    for (const Global v : original) held.push_back(is_held(v));
    for (Local row = 0; row < pattern.rows(); ++row)
      for (const Local column : pattern.columns(row))
        values.push_back(entry(original[row], original[column]));
    grid.start(held);
    grid.add(pattern.sparse_rows(), std::span<const double>(values));
    grid.finish();
  }

  /// S without the rows and columns of held vertices, P and P^T S P.
  Dense fine() const {
    Dense s = Dense::Zero(mesh.vertices.total, mesh.vertices.total);
    const auto& original = mesh.vertices.original;
    auto value = values.begin();
    for (Local row = 0; row < pattern.rows(); ++row)
      for (const Local column : pattern.columns(row)) {
        if (!held[row] && !held[column]) s(original[row], original[column]) = *value;
        ++value;
      }
    return summed(s);
  }
  Dense coarse() const {
    Dense s = Dense::Zero(grid.total(), grid.total());
    auto value = grid.values().begin();
    for (Local row = 0; row < grid.rows().size(); ++row)
      for (const Local column : grid.rows().columns(row))
        s(grid.nodes().global(row), grid.nodes().global(column)) = *value++;
    return summed(s);
  }
  Dense spread() const {
    Dense p = Dense::Zero(mesh.vertices.total, grid.total());
    std::vector<Vec3> c(grid.nodes().size()), x(mesh.vertices.size());
    for (Global n = 0; n < grid.total(); ++n) {
      for (Local i = 0; i < grid.nodes().owned; ++i)
        c[i] = grid.nodes().global(i) == n ? Vec3(0, 1, 0) : Vec3(Vec3::Zero());
      std::fill(x.begin(), x.end(), Vec3::Zero());
      grid.add_spread(c, x);
      for (Local i = 0; i < mesh.vertices.owned; ++i) p(mesh.vertices.original[i], n) = x[i][1];
    }
    return summed(p);
  }
  Dense gathered() const {
    Dense p = Dense::Zero(grid.total(), mesh.vertices.total);
    std::vector<Vec3> c(grid.nodes().size()), x(mesh.vertices.owned);
    for (Global v = 0; v < mesh.vertices.total; ++v) {
      for (Local i = 0; i < mesh.vertices.owned; ++i)
        x[i] = mesh.vertices.original[i] == v ? Vec3(0, 0, 1) : Vec3(Vec3::Zero());
      grid.gather(x, c);
      for (Local i = 0; i < grid.nodes().owned; ++i) p(grid.nodes().global(i), v) = c[i][2];
    }
    return summed(p);
  }
  /// Positions of all nodes, by global number.
  Dense points() const {
    Dense x = Dense::Zero(grid.total(), 3);
    for (Local i = 0; i < grid.nodes().owned; ++i)
      x.row(grid.nodes().global(i)) = grid.points()[i].transpose();
    return summed(x);
  }

  static Dense summed(Dense m) {
    sum_in_place(world, {m.data(), std::size_t(m.size())});
    return m;
  }

  DistributedMesh mesh;
  Pattern pattern;
  SplineGrid<2, double> grid;
  std::vector<double> values;
  std::vector<char> held;
};

void on_benches(const std::function<void(const Bench&)>& check) {
  for (const double spacing : {flat, in_space, close})
    on_odd_partitions(mixed_mesh, [&](DistributedMesh mesh) { check(Bench(std::move(mesh), spacing)); });
}

} // namespace

TEST(SplineGrid, SpreadsAndGathersByTheSameWeights) {
  on_benches([](const Bench& b) { EXPECT_LT(relative_error(b.gathered(), b.spread().transpose()), 1e-12); });
}

TEST(SplineGrid, MakesTheMatrixOfCoarseFunctions) {
  on_benches([](const Bench& b) {
    const Dense p = b.spread();
    EXPECT_LT(relative_error(b.coarse(), p.transpose() * b.fine() * p), 1e-12);
  });
}

// So smooth motion, whether of one axis or of all, is in reach of the grid.
TEST(SplineGrid, TellsLinearFunctions) {
  on_benches([](const Bench& b) {
    const Dense p = b.spread(), x = b.points(), found = p * x;
    for (Local i = 0; i < b.mesh.vertices.owned; ++i) {
      const Global v = b.mesh.vertices.original[i];
      if (is_held(v)) continue;
      EXPECT_NEAR(p.row(v).sum(), 1.0, 1e-6); // places within cells are kept in single precision
      EXPECT_NEAR(found(v, 0), b.mesh.rest_positions[i][0], 1e-6);
      EXPECT_NEAR(found(v, 1), b.mesh.rest_positions[i][1], 1e-6);
    }
  });
}

TEST(SplineGrid, DoesNotDependOnThePartition) {
  for (const double spacing : {flat, in_space}) {
    Global total = -1;
    on_odd_partitions(mixed_mesh, [&](DistributedMesh mesh) {
      const Bench b(std::move(mesh), spacing);
      if (total < 0) total = b.grid.total();
      EXPECT_EQ(b.grid.total(), total);
    });
  }
}

namespace {

/// The most iterations of the velocity solve in the first steps of a cloth held by two corners.
Global iterations(int side, double bending, double step, const std::string& partition) {
  Simulation simulation(world,
                        case_of(fmt::format("cloth:\n"
                                            "  grid: {{size: [1, 1], vertices: [{0}, {0}]}}\n"
                                            "  material: {{density: 0.2, bending: {1}, shear: 10}}\n"
                                            "pins: [{{vertices: [0, {2}]}}]\n"
                                            "time: {{end: {3}, frame_rate: {4}, max_step: {5}}}\n"
                                            "inextensibility: {{method: none}}\n"
                                            "partition: {{method: {6}}}\n",
                                            side, bending, side - 1, 2 * step, 0.5 / step, step, partition)));
  Recorder recorder(simulation);
  run_to_the_end(simulation, recorder);
  Global most = 0;
  for (const StepRecord& record : recorder.records) most = std::max(most, record.counts.velocity_iterations);
  return most;
}

} // namespace

// Stiffness couples ever more vertices as the mesh gets finer: by incomplete factors alone the three sizes
// take 35, 121 and 496 iterations on one rank.
TEST(VelocityIterations, DependNeitherOnTheMeshNorOnTheRanks) {
  for (const std::string partition : {"metis", "stripes"})
    for (const int side : {40, 80, 160}) EXPECT_LE(iterations(side, 1e-2, 0.02, partition), 25) << side;
}

// By incomplete factors alone 76, 190 and 548.
TEST(VelocityIterations, DoNotGrowWithStiffness) {
  for (const double bending : {1e-3, 1e-2, 1e-1}) EXPECT_LE(iterations(100, bending, 0.02, "metis"), 25);
}
