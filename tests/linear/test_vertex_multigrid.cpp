#include "src/linear/vertex_multigrid.hpp"
#include "tests/force_bed.hpp"

#include <map>
#include <numeric>

using namespace taut;
using namespace taut::test;

namespace {

constexpr double dt = 0.02; // s: inertia and stiffness weigh alike

MeshSlab flat_mesh(MPI_Comm comm) { return make_grid(comm, {1.0, 0.9}, {24, 21}); }

/// Grids around it have nodes in space.
MeshSlab wavy_mesh(MPI_Comm comm) {
  const MeshSlab grid = make_grid(self, {1.0, 0.6}, {22, 14});
  std::vector<Vec3> points = grid.rest_positions;
  for (Vec3& p : points) p[2] += 0.2 * std::sin(6 * p[0] + p[1]);
  return slab_of_whole(comm, points, grid.cell);
}

/// Scattered vertices held, kept on a line, or kept in a plane.
Freedom scattered_freedom(std::span<const Global> originals) {
  Freedom freedom(originals.size());
  for (std::size_t i = 0; i < originals.size(); ++i) {
    const Global v = originals[i];
    const Vec3 direction = Vec3(1 + double(v % 3), -2, double(v % 5) - 0.5).normalized();
    if (v % 17 == 3) freedom.hold(Local(i));
    if (v % 17 == 4) freedom.keep_on_line(Local(i), direction);
    if (v % 17 == 5) freedom.keep_in_plane(Local(i), direction);
  }
  return freedom;
}

/// Away from rest by a fifth of an edge.
WholeState moved_state(const Bed& whole) {
  WholeState state = random_state(whole, 0);
  const DistributedMesh& mesh = whole.cloth.mesh;
  const auto noise = random_vectors(mesh.vertices.total, 0.01, 5);
  for (Local i = 0; i < mesh.vertices.owned; ++i) {
    const Global v = mesh.vertices.original[i];
    state.positions[v] = mesh.rest_positions[i] + noise[v];
  }
  return state;
}

/// The matrix of a step with all forces, and its multigrid.
struct Bench {
  Bench(DistributedMesh mesh, const WholeState& state)
      : bed(std::move(mesh)), map(bed.cloth.mesh.vertices), system(full_step(bed, state, dt)),
        freedom(scattered_freedom(map.original)), filtered(bed.cloth.mesh),
        multigrid(bed.cloth.mesh, bed.pattern) {
    filtered.set(system.matrix(), freedom);
    multigrid.set(filtered);
  }

  MPI_Comm comm() const { return bed.cloth.mesh.comm; }

  /// From values in original order, and back.
  std::vector<Vec3> owned(const std::vector<Vec3>& all) const {
    std::vector<Vec3> values = local(map, all);
    values.resize(map.owned);
    return values;
  }
  Column whole(std::span<const Vec3> values) const { return gather<Vec3>(comm(), map, values); }

  Column cycle(const std::vector<Vec3>& b) const {
    std::vector<Vec3> x(map.owned);
    multigrid.solve(owned(b), x);
    return whole(x);
  }

  Bed bed;
  const IndexMap& map;
  StepSystem system;
  Freedom freedom;
  FilteredOperator filtered;
  VertexMultigrid multigrid;
};

/// The same on one rank, as whole matrices.
struct Whole {
  explicit Whole(const MakeMesh& mesh) : state(moved_state(Bed(serial(mesh)))), bench(serial(mesh), state) {
    const Dense plain = gather(bench.bed.cloth.mesh, bench.system.matrix());
    s = Dense::Zero(plain.rows(), plain.cols());
    for (Local i = 0; i < bench.map.owned; ++i) {
      const Eigen::Index row = 3 * bench.map.original[i];
      s.block<3, 3>(row, row) = bench.freedom.projector(i);
    }
    a = s * plain * s;
    for (std::size_t k = 0; k < bench.multigrid.levels(); ++k) {
      number.emplace_back();
      for (const Global key : bench.multigrid.grid(k).nodes().original)
        number[k].emplace(key, Global(number[k].size()));
      spread.push_back(s * spread_of(k));
      coarse.push_back(spread[k].transpose() * a * spread[k]);
    }
  }

  Dense spread_of(std::size_t k) const {
    Dense p = Dense::Zero(s.rows(), 3 * Global(number[k].size()));
    for (Local i = 0; i < bench.map.owned; ++i)
      bench.multigrid.for_each_weight(k, i, [&](Global key, double weight) {
        p.block<3, 3>(3 * bench.map.original[i], 3 * number[k].at(key)) = weight * Mat3::Identity();
      });
    return p;
  }

  /// Values of owned nodes of a grid, anywhere, in the order of this one.
  Column nodes(const Bench& other, std::size_t k, std::span<const Vec3> values) const {
    Column all = Column::Zero(3 * Global(number[k].size()));
    const IndexMap& map = other.multigrid.grid(k).nodes();
    for (Local i = 0; i < map.owned; ++i) all.segment<3>(3 * number[k].at(map.original[i])) = values[i];
    sum_in_place(other.comm(), {all.data(), std::size_t(all.size())});
    return all;
  }

  WholeState state;
  Bench bench;
  Dense s, a;                                   ///< S and S A S
  std::vector<std::map<Global, Global>> number; ///< of the nodes of each grid, by key
  std::vector<Dense> spread, coarse;            ///< S P_k, and P_k^T S A S P_k
};

const Whole& whole_of(bool is_flat) {
  static const Whole flat(flat_mesh), wavy(wavy_mesh);
  return is_flat ? flat : wavy;
}

/// On all odd partitions of a flat and a wavy sheet.
void on_benches(const std::function<void(const Bench&, const Whole&)>& check) {
  for (const bool is_flat : {true, false}) {
    const Whole& whole = whole_of(is_flat);
    on_odd_partitions(is_flat ? flat_mesh : wavy_mesh,
                      [&](DistributedMesh mesh) { check(Bench(std::move(mesh), whole.state), whole); });
  }
}

std::vector<Vec3> some_vectors(const Whole& whole, unsigned seed) {
  return random_vectors(whole.bench.map.total, 1, seed);
}

} // namespace

TEST(VertexMultigrid, MakesTheMatricesOfCoarseFunctions) {
  on_benches([](const Bench& b, const Whole& whole) {
    ASSERT_EQ(b.multigrid.levels(), 2);
    for (std::size_t k = 0; k < 2; ++k) {
      const auto& grid = b.multigrid.grid(k);
      ASSERT_EQ(grid.total(), Global(whole.number[k].size()));
      Dense found = Dense::Zero(3 * grid.total(), 3 * grid.total());
      auto value = grid.values().begin();
      const auto number = [&](Local node) { return 3 * whole.number[k].at(grid.nodes().original[node]); };
      for (Local row = 0; row < grid.rows().size(); ++row)
        for (const Local column : grid.rows().columns(row))
          found.block<3, 3>(number(row), number(column)) = *value++;
      sum_in_place(world, {found.data(), std::size_t(found.size())});
      EXPECT_LT(relative_error(found, whole.coarse[k]), 1e-9);
    }
  });
}

TEST(VertexMultigrid, GridsAreNested) {
  on_benches([](const Bench& b, const Whole&) {
    const auto &fine = b.multigrid.grid(0).cells(), &coarse = b.multigrid.grid(1).cells();
    EXPECT_DOUBLE_EQ(b.multigrid.spacing(1), 3 * b.multigrid.spacing(0));
    for (Local i = 0; i < b.map.size(); ++i) { // ghosts as well
      std::map<Global, double> difference;
      b.multigrid.for_each_weight(1, i, [&](Global key, double weight) { difference[key] += weight; });
      b.multigrid.for_each_weight(0, i, [&](Global key, double weight) {
        coarse.for_each_weight(fine.node_point(key),
                               [&](Global over, double w) { difference[over] -= weight * w; });
      });
      for (const auto& [key, d] : difference) EXPECT_NEAR(d, 0, 1e-9);
    }
  });
}

TEST(VertexMultigrid, RestrictsByTheWeights) {
  on_benches([](const Bench& b, const Whole& whole) {
    const auto all = some_vectors(whole, 21);
    for (std::size_t k = 0; k < 2; ++k) {
      std::vector<Vec3> coarse;
      b.multigrid.restrict_to(k, b.owned(all), coarse);
      const Column expected = whole.spread[k].transpose() * whole.bench.whole(whole.bench.owned(all));
      EXPECT_LT(relative_error(whole.nodes(b, k, coarse), expected), 1e-9);
    }
  });
}

TEST(VertexMultigrid, ACycleDoesNotDependOnThePartition) {
  on_benches([](const Bench& b, const Whole& whole) {
    const auto all = some_vectors(whole, 22);
    EXPECT_LT(relative_error(b.cycle(all), whole.bench.cycle(all)), 1e-9);
  });
}

TEST(VertexMultigrid, GoesOnFromASolutionOnAGrid) {
  on_benches([](const Bench& b, const Whole& whole) {
    const auto all = some_vectors(whole, 23);
    std::vector<Vec3> coarse;
    b.multigrid.restrict_to(1, b.owned(all), coarse);
    const Column scale = whole.coarse[1].diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    const Dense scaled = scale.asDiagonal() * whole.coarse[1] * scale.asDiagonal();
    const Column right = scale.asDiagonal() * whole.nodes(b, 1, coarse);
    const Column solved = scale.asDiagonal() * scaled.completeOrthogonalDecomposition().solve(right);
    const IndexMap& nodes = b.multigrid.grid(1).nodes();
    std::vector<Vec3> start, x(b.map.owned);
    for (Local i = 0; i < nodes.owned; ++i)
      start.emplace_back(solved.segment<3>(3 * whole.number[1].at(nodes.original[i])));
    b.multigrid.solve(b.owned(all), 1, start, x);
    EXPECT_LT(relative_error(b.whole(x), b.cycle(all)), 1e-6);
  });
}

namespace {

/// The mean factor by which a cycle reduces the error in the norm of the matrix.
double rate(const MakeMesh& make) {
  constexpr int cycles = 20;
  const WholeState state = moved_state(Bed(serial(make)));
  const MeshSlab slab = make(world);
  const Bench b(distribute_by(world, slab, odd_owners(slab.vertices.total, size_of(world))[0]), state);
  std::vector<Vec3> error = b.owned(random_vectors(b.map.total, 1, 31)), product(b.map.owned), x = product;
  const auto size = [&] {
    b.filtered.apply(error, product);
    double sum = 0;
    for (Local i = 0; i < b.map.owned; ++i) sum += error[i].dot(product[i]);
    return std::sqrt(sum_over(b.comm(), sum));
  };
  const double start = size();
  for (int n = 0; n < cycles; ++n) {
    b.multigrid.solve(product, x);
    for (Local i = 0; i < b.map.owned; ++i) error[i] -= x[i];
    size();
  }
  return std::pow(size() / start, 1.0 / cycles);
}

} // namespace

TEST(VertexMultigrid, ACycleReducesTheErrorOfSmallAndLargeCloths) {
  EXPECT_LT(rate(mixed_mesh), 0.8);
  EXPECT_LT(rate(flat_mesh), 0.8);
  EXPECT_LT(rate([](MPI_Comm comm) { return make_grid(comm, {1, 1}, {80, 80}); }), 0.8);
}
