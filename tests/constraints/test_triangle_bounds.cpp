// Bounds of single triangles: rows of those beyond them, and Fast Projection onto both.
#include "src/constraints/strain_gauge.hpp"
#include "src/filters/fast_projection.hpp"
#include "tests/support.hpp"

#include <gtest/gtest.h>

using namespace taut;
using namespace taut::test;

namespace {

constexpr double dt = 0.01; // s
constexpr auto all_edges = ConstrainedEdges::all;
using Bounded = BoundedSet<MixedSet>;

config::Inextensibility limits(double strain, double faces) {
  config::Inextensibility limits;
  limits.constrain = config::Constrain::vertices;
  limits.strain = strain;
  limits.faces = faces;
  return limits;
}

/// Quads and triangles away from their rest shape, so that some triangles are beyond their bound.
struct Strained {
  Cloth cloth;
  Bounded set;
  State start;
  Candidate candidate;
  std::vector<Vec3> x, u;

  explicit Strained(DistributedMesh mesh)
      : cloth(make_cloth(std::move(mesh), config::Material{})), set(cloth, limits(0.1, 1)) {
    const IndexMap& vertices = cloth.mesh.vertices;
    x = local(vertices, random_vectors(vertices.total, 0.02, 1));
    u = local(vertices, random_vectors(vertices.total, 1, 2));
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += cloth.mesh.rest_positions[i];
    start.positions = cloth.mesh.rest_positions;
    start.multipliers.force_density.assign(cloth.mesh.edges.size(), 0.0);
    start.multipliers.stress.assign(x.size(), Vec2::Zero());
    candidate.reset_for(start);
    set.start(start, dt, Freedom(x.size()), candidate);
    set.evaluate(x);
  }

  /// Of the rows that single triangles have.
  std::size_t bounds() const { return set.rows() - MixedSet(cloth, limits(0.1, 1)).rows(); }

  std::vector<double> values(double along) {
    std::vector<Vec3> moved = x;
    for (std::size_t i = 0; i < x.size(); ++i) moved[i] += along * u[i];
    set.evaluate(moved);
    std::vector<double> c(set.rows());
    set.residual(c);
    return c;
  }
};

} // namespace

TEST(TriangleBounds, DifferenceIsTheDerivativeOfTheValues) {
  on_odd_partitions(
      quads_and_triangles,
      [](DistributedMesh mesh) {
        Strained t(std::move(mesh));
        EXPECT_GT(sum_over(world, Global(t.bounds())), 0);
        constexpr double epsilon = 1e-7;
        const auto ahead = t.values(epsilon), behind = t.values(-epsilon);
        t.set.evaluate(t.x);
        std::vector<double> rows(t.set.rows(), 0.0);
        t.set.subtract_difference(t.u, rows);
        ASSERT_EQ(rows.size(), ahead.size());
        ASSERT_EQ(rows.size(), behind.size());
        for (std::size_t r = 0; r < rows.size(); ++r)
          EXPECT_NEAR(-rows[r], (ahead[r] - behind[r]) / (2 * epsilon), 1e-6) << r;
      },
      all_edges);
}

TEST(TriangleBounds, SpreadIsTheAdjointOfDifference) {
  on_odd_partitions(
      quads_and_triangles,
      [](DistributedMesh mesh) {
        Strained t(std::move(mesh));
        std::vector<double> z(t.set.rows()), rows(z.size(), 0.0);
        for (std::size_t r = 0; r < z.size(); ++r) z[r] = std::sin(1.0 + double(r));
        t.set.subtract_difference(t.u, rows);
        std::vector<Vec3> field(t.x.size(), Vec3::Zero());
        t.set.begin_spread(z);
        t.set.end_spread(field);
        double by_rows = 0, by_vertices = 0;
        for (std::size_t r = 0; r < z.size(); ++r) by_rows += z[r] * rows[r];
        for (Local i = 0; i < t.cloth.mesh.vertices.owned; ++i) by_vertices += field[i].dot(t.u[i]);
        by_rows = sum_over(world, by_rows);
        EXPECT_NEAR(by_rows, sum_over(world, by_vertices), 1e-12 * (1 + std::abs(by_rows)));
      },
      all_edges);
}

// Vertices of a sheet of triangles are thrown in all directions: averages are kept with bounds or
// without, single triangles only with them.
TEST(TriangleBounds, AreKeptWhereAveragesAlonePermitMore) {
  const auto uneven = [](MPI_Comm comm) {
    const MeshSlab grid = make_grid(self, {0.8, 0.6}, {9, 7}, GridCells::alternating_triangles);
    std::vector<Vec3> points = grid.rest_positions;
    const auto noise = random_vectors(Global(points.size()), 0.03, 3);
    for (std::size_t i = 0; i < points.size(); ++i) points[i] += Vec3(noise[i][0], noise[i][1], 0);
    return slab_of_whole(comm, points, grid.cell);
  };
  on_odd_partitions(uneven, [](DistributedMesh mesh) {
    const Cloth cloth = make_cloth(std::move(mesh), config::Material{});
    const std::vector<Tangent> tangents = tangents_of(cloth);
    const auto face_strain_with = [&](double faces) {
      config::Inextensibility how = limits(0.01, faces);
      how.max_iterations = 40;
      how.compliance = 1e-5;
      FastProjection<BoundedSet<MetricSet>> filter(cloth, how);
      State start;
      start.positions = cloth.mesh.rest_positions;
      start.multipliers.force_density.assign(cloth.mesh.edges.size(), 0.0);
      start.multipliers.stress.assign(start.positions.size(), Vec2::Zero());
      Candidate candidate;
      candidate.reset_for(start);
      candidate.velocities = local(cloth.mesh.vertices, random_vectors(cloth.mesh.vertices.total, 3, 4));
      EXPECT_EQ(filter.apply(start, dt, Freedom(start.positions.size()), candidate).failure, "");
      std::vector<Vec3> x = start.positions;
      for (std::size_t i = 0; i < x.size(); ++i) x[i] += dt * candidate.velocities[i];
      EXPECT_LE(StrainGauge(cloth, config::Constrain::vertices).measure(x).max, how.strain);
      return largest_strain(cloth, tangents, x);
    };
    EXPECT_GT(face_strain_with(1000), 0.03);
    EXPECT_LE(face_strain_with(3), 0.03);
  });
}
