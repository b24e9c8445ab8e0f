// The metric of taut threads against dense algebra, and what it is there for.
#include "src/constraints/thread_stiffness.hpp"
#include "tests/simulate.hpp"
#include "tests/support.hpp"

#include <gtest/gtest.h>

using namespace taut;
using namespace taut::test;

namespace {

constexpr double dt = 0.01; // s

config::Inextensibility slightly_compliant() {
  config::Inextensibility options;
  options.compliance = 1.5e-4; // 1/N
  return options;
}

/// A cloth with tensions in which some edges outweigh all inertia and others none, and what comes of it as
/// whole matrices over vertices, one axis at a time.
struct Bench {
  Cloth cloth;
  Yarns yarns;
  EdgeConstraints constraints;
  ThreadStiffness threads;
  std::vector<double> mu, tried;

  explicit Bench(DistributedMesh mesh)
      : cloth(make_cloth(std::move(mesh), config::Material{})), yarns(find_yarns(cloth.mesh)),
        constraints(cloth, slightly_compliant()), threads(cloth, yarns) {
    const DistributedMesh& m = cloth.mesh;
    Freedom freedom(m.vertices.size());
    constraints.start(dt, freedom);
    constraints.evaluate(m.rest_positions);
    const auto sizes = random_numbers(m.edges.total, 1.0, 5), others = random_numbers(m.edges.total, 1.0, 6);
    for (const Global e : m.edges.original) {
      mu.push_back(sizes[e] > 0 ? 1e3 * sizes[e] : 1e-4);
      tried.push_back(others[e]);
    }
    EXPECT_TRUE(ThreadStiffness::is_needed(constraints, mu));
    threads.choose(constraints, mu);
  }

  Global vertices() const { return cloth.mesh.vertices.total; }

  Dense inverse_masses() const {
    Dense w = Dense::Zero(vertices(), vertices());
    for (Local i = 0; i < cloth.mesh.vertices.owned; ++i) {
      const Global v = cloth.mesh.vertices.original[i];
      w(v, v) = constraints.inverse_mass()[i];
    }
    return summed(w);
  }
  /// B^T D B of the edges that were chosen.
  Dense stiffness() const {
    Dense k = Dense::Zero(vertices(), vertices());
    for (Local e = 0; e < cloth.mesh.edges.owned; ++e) {
      const auto [a, b] = originals(e);
      const double d = threads.stiffness(e);
      k(a, a) += d, k(b, b) += d, k(a, b) -= d, k(b, a) -= d;
    }
    return summed(k);
  }
  /// J^T mu, a row a vertex.
  Dense pull() const {
    Dense p = Dense::Zero(vertices(), 3);
    for (Local e = 0; e < cloth.mesh.edges.owned; ++e) {
      const auto [a, b] = originals(e);
      p.row(a) -= tried[e] * constraints.gradients()[e].transpose();
      p.row(b) += tried[e] * constraints.gradients()[e].transpose();
    }
    return summed(p);
  }
  Dense held_back() {
    threads.hold_back(constraints, tried);
    Dense h = Dense::Zero(vertices(), 3);
    for (Local i = 0; i < cloth.mesh.vertices.owned; ++i)
      h.row(cloth.mesh.vertices.original[i]) = threads.held_back(i).transpose();
    return summed(h);
  }

  std::pair<Global, Global> originals(Local edge) const {
    const auto& [a, b] = cloth.mesh.edge_vertices[edge];
    return {cloth.mesh.vertices.original[a], cloth.mesh.vertices.original[b]};
  }
  static Dense summed(Dense m) {
    sum_in_place(world, {m.data(), std::size_t(m.size())});
    return m;
  }
};

MeshSlab grid(MPI_Comm comm) { return make_grid(comm, {0.8, 0.6}, {9, 7}); }

void on_benches(const std::function<void(Bench&)>& check) {
  for (const MakeMesh& make : {MakeMesh(grid), MakeMesh(tube_mesh), MakeMesh(mixed_mesh)})
    on_odd_partitions(make, [&](DistributedMesh mesh) {
      Bench bench(std::move(mesh));
      check(bench);
    });
}

} // namespace

TEST(ThreadStiffness, IsTheMetricOfNewtonsMethod) {
  on_benches([](Bench& b) {
    ASSERT_TRUE(b.threads.acts());
    const Dense w = b.inverse_masses(), mass = w.inverse(), pull = b.pull();
    const Dense expected = w * pull - (mass + b.stiffness()).inverse() * pull;
    EXPECT_LT(relative_error(b.held_back(), expected), 1e-8); // D is 1e6 times M
  });
}

TEST(ThreadStiffness, IsTheSameOnAnyPartition) {
  for (const MakeMesh& make : {MakeMesh(grid), MakeMesh(tube_mesh)}) {
    const Dense expected = [&] {
      Bench b(serial(make));
      Dense k = Dense::Zero(b.vertices(), b.vertices());
      for (Local e = 0; e < b.cloth.mesh.edges.owned; ++e) {
        const auto [i, j] = b.originals(e);
        k(i, j) = k(j, i) = -b.threads.stiffness(e);
      }
      return k;
    }();
    on_odd_partitions(make, [&](DistributedMesh mesh) {
      Dense found = Bench(std::move(mesh)).stiffness();
      found.diagonal().setZero();
      EXPECT_LT(relative_error(found, expected), 1e-12);
    });
  }
}

TEST(ThreadStiffness, LeavesOutWhatHardlyPulls) {
  on_odd_partitions(grid, [](DistributedMesh mesh) {
    Bench b(std::move(mesh));
    std::fill(b.mu.begin(), b.mu.end(), 1e-9);
    b.threads.choose(b.constraints, b.mu);
    EXPECT_FALSE(b.threads.acts());
    EXPECT_FALSE(ThreadStiffness::is_needed(b.constraints, b.mu));
  });
}

// The upper hem has no slack between the pins. In the metric of masses alone this takes five to six
// projections a step and rejects steps.
TEST(ThreadStiffness, LetsAThreadWithoutSlackSettle) {
  const std::string text = R"(
name: hem
cloth:
  grid: {size: [1, 1], vertices: [81, 81]}
  material: {density: 0.2, bending: 1e-5, shear: 10}
pins: [{vertices: [0, 80]}]
time: {end: 0.2, frame_rate: 5, max_step: 10 ms}
)";
  Simulation simulation(world, case_of(text));
  Recorder recorder(simulation);
  run_to_the_end(simulation, recorder);
  int projections = 0, rejected = 0;
  for (const StepRecord& r : recorder.records) {
    projections += r.counts.iterations;
    rejected += r.rejected;
  }
  EXPECT_EQ(rejected, 0);
  EXPECT_LE(projections, 3 * int(recorder.records.size()));
}
