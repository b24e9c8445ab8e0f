// The metric averaged at vertices, and Fast Projection onto it.
#include "src/constraints/strain_gauge.hpp"
#include "src/filters/fast_projection.hpp"
#include "tests/support.hpp"

#include <gtest/gtest.h>

#include <numbers>

using namespace taut;
using namespace taut::test;

namespace {

constexpr double dt = 0.01; // s
constexpr auto cg = config::LinearSolver::cg, mumps = config::LinearSolver::mumps;

MeshSlab flat_triangles(MPI_Comm comm) {
  return make_grid(comm, {0.8, 0.6}, {9, 7}, GridCells::alternating_triangles);
}

/// A flat sheet whose triangles are all different, some of them obtuse; warp along x.
MeshSlab uneven_triangles(MPI_Comm comm) {
  const MeshSlab grid = flat_triangles(self);
  std::vector<Vec3> points = grid.rest_positions;
  const auto noise = random_vectors(Global(points.size()), 0.03, 3);
  for (std::size_t i = 0; i < points.size(); ++i) points[i] += Vec3(noise[i][0], noise[i][1], 0);
  return slab_of_whole(comm, points, grid.cell);
}

std::vector<Vec2> metric_at(const Cloth& cloth, std::span<const Vec3> positions) {
  const AveragedMetric metric(cloth);
  std::vector<Vec2> result;
  for (Local i = 0; i < cloth.mesh.vertices.owned; ++i) result.push_back(metric.at(i, positions));
  return result;
}

config::Inextensibility limits(double strain, config::LinearSolver solver) {
  config::Inextensibility limits;
  limits.constrain = config::Constrain::vertices;
  limits.strain = strain;
  limits.solver = solver;
  limits.compliance = 1e-5;
  return limits;
}

/// A step of a sheet at rest in its plane that is about to be torn out of it; two corners are held.
struct Throw {
  Cloth cloth;
  State start;
  Candidate candidate;
  std::vector<char> held;

  explicit Throw(DistributedMesh mesh) : cloth(make_cloth(std::move(mesh), config::Material{})) {
    const IndexMap& map = cloth.mesh.vertices;
    start.positions = cloth.mesh.rest_positions;
    start.multipliers.stress.assign(map.size(), Vec2::Zero());
    held.assign(map.size(), 0);
    for (const Vec3& p : cloth.mesh.rest_positions) // stretch to 1.15, shear, and a wave 10 cm high
      candidate.velocities.emplace_back(15 * p[0] + 10 * p[1], -10 * p[1],
                                        10 * std::sin(8 * p[0] + 5 * p[1]));
    candidate.multipliers.force_density.assign(cloth.mesh.edges.size(), 0.0);
    candidate.multipliers.stress = start.multipliers.stress;
  }

  void hold_corners() {
    for (Local i = 0; i < cloth.mesh.vertices.size(); ++i)
      if (const Global v = cloth.mesh.vertices.original[i]; v == 0 || v == 8) {
        held[i] = 1;
        candidate.velocities[i].setZero();
      }
  }

  FilterReport project(const config::Inextensibility& how) {
    return FastProjection<MetricSet>(cloth, how).apply(start, dt, Freedom(held), candidate);
  }
  std::vector<Vec3> end() const {
    std::vector<Vec3> x = start.positions;
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += dt * candidate.velocities[i];
    return x;
  }
  double strain() const { return StrainGauge(cloth, config::Constrain::vertices).measure(end()).max; }

  Vec3 momentum() const {
    Vec3 sum = Vec3::Zero();
    for (Local i = 0; i < cloth.mesh.vertices.owned; ++i) sum += cloth.mass[i] * candidate.velocities[i];
    sum_in_place(cloth.mesh.comm, {sum.data(), 3});
    return sum;
  }
};

} // namespace

// x = (p u, q v) has the metric (p^2, q^2) everywhere, and a shear in the plane leaves that of warp alone.
TEST(AveragedMetric, IsExactWhereTheMetricIsConstant) {
  on_odd_partitions(uneven_triangles, [](DistributedMesh mesh) {
    const Cloth cloth = make_cloth(std::move(mesh), config::Material{});
    std::vector<Vec3> x;
    for (const Vec3& p : cloth.mesh.rest_positions) x.emplace_back(1.2 * p[0], 0.9 * p[1], 0.1 * p[1]);
    for (const Vec2& g : metric_at(cloth, x)) {
      EXPECT_NEAR(g[0], 1.44, 1e-12);
      EXPECT_NEAR(g[1], 0.82, 1e-12);
    }
    for (const Vec2& g : metric_at(cloth, cloth.mesh.rest_positions))
      EXPECT_LT((g - Vec2::Ones()).norm(), 1e-12);
  });
}

// Triangles that follow a bend are chords of it: shorter by at most (edge / radius)^2 / 24.
TEST(AveragedMetric, OfACylinderIsFlatToSecondOrder) {
  for (const double radius : {1.0, 0.5}) {
    const Cloth cloth = make_cloth(serial(uneven_triangles), config::Material{});
    std::vector<Vec3> x;
    double edge = 0;
    for (const double l : cloth.rest_length) edge = std::max(edge, l);
    for (const Vec3& p : cloth.mesh.rest_positions)
      x.emplace_back(radius * std::sin(p[0] / radius), p[1], radius * std::cos(p[0] / radius));
    const double strain = StrainGauge(cloth, config::Constrain::vertices).measure(x).max;
    EXPECT_LT(strain, std::pow(edge / radius, 2) / 24 * 2);
    EXPECT_GT(strain, 1e-5);
  }
}

TEST(AveragedMetric, IsTheSameOnAnyPartition) {
  const DistributedMesh whole = serial(uneven_triangles);
  const auto noise = random_vectors(whole.vertices.total, 0.05, 4);
  const auto all = [&](DistributedMesh mesh) {
    const Cloth cloth = make_cloth(std::move(mesh), config::Material{});
    std::vector<Vec3> x = cloth.mesh.rest_positions;
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += noise[cloth.mesh.vertices.original[i]];
    return gather<Vec2>(cloth.mesh.comm, cloth.mesh.vertices, metric_at(cloth, x));
  };
  const Column expected = all(serial(uneven_triangles));
  on_odd_partitions(uneven_triangles, [&](DistributedMesh mesh) {
    EXPECT_LT((all(std::move(mesh)) - expected).lpNorm<Eigen::Infinity>(), 1e-13);
  });
}

TEST(MetricSet, BringStrainWithinTheLimit) {
  for (const auto solver : {cg, mumps})
    for (const MakeMesh& make : {MakeMesh(flat_triangles), MakeMesh(uneven_triangles)})
      on_odd_partitions(make, [&](DistributedMesh mesh) {
        Throw t(std::move(mesh));
        t.hold_corners();
        EXPECT_GT(t.strain(), 0.05);
        const FilterReport report = t.project(limits(0.01, solver));
        EXPECT_EQ(report.failure, "");
        EXPECT_LE(t.strain(), 0.01);
        for (Local i = 0; i < t.cloth.mesh.vertices.size(); ++i) {
          if (t.held[i]) {
            EXPECT_EQ(t.candidate.velocities[i].norm(), 0);
          }
        }
      });
}

// Tensions are internal: they leave the momentum of a free cloth alone, and their work on a small motion is
// what the constraints change by it.
TEST(MetricSet, KeepsMomentum) {
  on_odd_partitions(uneven_triangles, [](DistributedMesh mesh) {
    Throw t(std::move(mesh));
    const Vec3 before = t.momentum();
    EXPECT_EQ(t.project(limits(0.01, cg)).failure, "");
    EXPECT_LT((t.momentum() - before).norm(), 1e-13);
  });
}

TEST(MetricSet, PullAlongTheDerivativesOfTheConstraints) {
  Throw t(serial(uneven_triangles));
  const auto before = t.candidate.velocities;
  MetricSet rows(t.cloth, limits(0.01, mumps));
  const std::vector<Vec3> x = t.end();
  rows.start(t.start, dt, Freedom(t.held), t.candidate);
  rows.evaluate(x);
  EXPECT_EQ(rows.solve(1e-10).failure, "");
  rows.finish(t.candidate);
  const auto direction = random_vectors(Global(x.size()), 1.0, 9);
  constexpr double epsilon = 1e-6;
  std::vector<Vec3> ahead = x, behind = x;
  for (std::size_t i = 0; i < x.size(); ++i) {
    ahead[i] += epsilon * direction[i];
    behind[i] -= epsilon * direction[i];
  }
  // sum of A sigma/2 (g(ahead) - g(behind)) against the work of the pulls m W J^T d_mu / h^2
  const std::vector<Vec2> g1 = metric_at(t.cloth, ahead), g0 = metric_at(t.cloth, behind);
  double work = 0, expected = 0;
  for (Local i = 0; i < t.cloth.mesh.vertices.owned; ++i) {
    expected +=
        0.5 * t.cloth.measure[i] * t.candidate.multipliers.stress[i].dot(g1[i] - g0[i]) / (2 * epsilon);
    work += t.cloth.mass[i] / (dt * dt) * rows.displacement(i).dot(direction[i]);
  }
  EXPECT_GT(std::abs(expected), 1);
  EXPECT_NEAR(work / expected, 1, 1e-7);
  // The same told as force densities of edges.
  double along_edges = 0;
  for (Local e = 0; e < t.cloth.mesh.edges.owned; ++e) {
    const auto& [a, b] = t.cloth.mesh.edge_vertices[e];
    along_edges += t.candidate.multipliers.force_density[e] * (x[b] - x[a]).dot(direction[b] - direction[a]);
  }
  EXPECT_NEAR(along_edges / expected, 1, 1e-7);
}

// (J W J^T + a) d_mu = C: a small part of the pull changes the constraints by that part of C - a d_mu.
TEST(MetricSet, SolveForWhatIsLeft) {
  for (const auto solver : {cg, mumps})
    on_odd_partitions(uneven_triangles, [&](DistributedMesh mesh) {
      Throw t(std::move(mesh));
      t.hold_corners();
      const DistributedMesh& m = t.cloth.mesh;
      const config::Inextensibility how = limits(1e-3, solver);
      MetricSet rows(t.cloth, how);
      const std::vector<Vec3> x = t.end();
      rows.start(t.start, dt, Freedom(t.held), t.candidate);
      rows.evaluate(x);
      EXPECT_EQ(rows.solve(1e-10).failure, "");
      rows.finish(t.candidate);
      constexpr double part = 1e-6;
      std::vector<Vec3> ahead = x, behind = x;
      for (Local i = 0; i < m.vertices.owned; ++i) {
        ahead[i] += part * rows.displacement(i);
        behind[i] -= part * rows.displacement(i);
      }
      m.vertex_halo.update(ahead);
      m.vertex_halo.update(behind);
      const auto g = metric_at(t.cloth, x), g1 = metric_at(t.cloth, ahead), g0 = metric_at(t.cloth, behind);
      for (Local i = 0; i < m.vertices.owned; ++i) {
        const Vec2 change = (g1[i] - g0[i]) / (2 * part);
        const Vec2 strained =
            2 * *how.compliance * std::sqrt(t.cloth.measure[i]) * t.candidate.multipliers.stress[i];
        EXPECT_LT((change + strained - (g[i] - Vec2::Ones())).norm(), 1e-5) << m.vertices.original[i];
      }
    });
}

// A compliance is of length over force: in short steps a row would yield more than its masses do.
TEST(MetricSet, YieldWithContactByAThousandthOfWhatTheirMassesDo) {
  const config::Inextensibility how = limits(0.01, cg);
  constexpr double short_step = 1e-4; // s
  for (const auto use : {ConstraintUse::alone, ConstraintUse::with_contact}) {
    Throw t(serial(uneven_triangles));
    MetricSet rows(t.cloth, how, use);
    rows.start(t.start, short_step, Freedom(t.held), t.candidate);
    rows.evaluate(t.start.positions);
    const auto compliance = rows.program_compliance();
    for (Local i = 0; i < t.cloth.mesh.vertices.owned; ++i) {
      const double asked = 4 * *how.compliance * std::sqrt(t.cloth.measure[i]) / (short_step * short_step);
      const double most = 1e-3 * 4 / t.cloth.mass[i];
      ASSERT_GT(asked, 2 * most);
      const double expected = use == ConstraintUse::alone ? asked : most;
      for (int k = 0; k < 2; ++k) EXPECT_NEAR(compliance[2 * i + k] / expected, 1, 1e-12);
    }
  }
}

// What pushes is carried too: to leave it out made tension ratchet on irregular triangles.
TEST(MetricSet, CarriesTensionAndPushes) {
  Throw t(serial(uneven_triangles));
  auto& stress = t.start.multipliers.stress;
  for (std::size_t i = 0; i < stress.size(); ++i) stress[i] = Vec2(3.0 + double(i), -2.0) * (i % 2 ? 1 : -1);
  MetricSet rows(t.cloth, limits(0.01, cg));
  rows.start(t.start, dt, Freedom(t.held), t.candidate);
  rows.evaluate(t.start.positions);
  rows.finish(t.candidate);
  for (std::size_t i = 0; i < stress.size(); ++i)
    EXPECT_LT((t.candidate.multipliers.stress[i] - stress[i]).norm(), 1e-12 * stress[i].norm()) << i;
}

TEST(MetricSet, LeaveTheSameShapeOnAnyPartition) {
  const auto end = [](DistributedMesh mesh) {
    Throw t(std::move(mesh));
    t.hold_corners();
    EXPECT_EQ(t.project(limits(0.01, mumps)).failure, "");
    return gather<Vec3>(t.cloth.mesh.comm, t.cloth.mesh.vertices, t.end());
  };
  const Column expected = end(serial(uneven_triangles));
  on_odd_partitions(uneven_triangles, [&](DistributedMesh mesh) {
    EXPECT_LT((end(std::move(mesh)) - expected).lpNorm<Eigen::Infinity>(), 1e-9);
  });
}
