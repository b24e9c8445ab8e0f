// What all sets of constraints promise: J^T and J are each other's adjoints and the derivative of C, on any
// partition, and contact takes any set.
#include "src/config/case.hpp"
#include "src/constraints/bounded_set.hpp"
#include "src/contact/intersections.hpp"
#include "src/filters/contact_projection.hpp"
#include "tests/support.hpp"

#include <gtest/gtest.h>

using namespace taut;
using namespace taut::test;

namespace {

constexpr double dt = 0.01; // s

/// The values of a set by their definitions, to take differences of.
template<class Set>
std::vector<double> values(const Cloth& cloth, std::span<const Vec3> x);

template<>
std::vector<double> values<EdgeSet>(const Cloth& cloth, std::span<const Vec3> x) {
  std::vector<double> c;
  for (Local e = 0; e < cloth.mesh.edges.owned; ++e) {
    const auto& [a, b] = cloth.mesh.edge_vertices[e];
    const double l = cloth.rest_length[e];
    c.push_back((x[b] - x[a]).squaredNorm() / l - l);
  }
  return c;
}

template<>
std::vector<double> values<MetricSet>(const Cloth& cloth, std::span<const Vec3> x) {
  const AveragedMetric metric(cloth);
  std::vector<double> c;
  for (Local i = 0; i < cloth.mesh.vertices.owned; ++i)
    for (const double g : metric.at(i, x)) c.push_back(std::sqrt(metric.area(i)) * (g - 1));
  return c;
}

/// Of sides of quads the lengths; metrics only where there is no quad.
template<>
std::vector<double> values<MixedSet>(const Cloth& cloth, std::span<const Vec3> x) {
  std::vector<double> c = values<EdgeSet>(cloth, x);
  const auto is_thread = find_threads(cloth.mesh);
  for (std::size_t e = 0; e < c.size(); ++e) c[e] *= is_thread[e];
  const std::vector<double> of_metric = values<MetricSet>(cloth, x);
  c.insert(c.end(), of_metric.begin(), of_metric.end());
  return c;
}

/// One number for each entity or several, the same whatever the partition.
std::vector<double> numbers_of(const IndexMap& map, std::size_t per_entity) {
  const auto all = random_numbers(map.total * Global(per_entity), 1, 5);
  std::vector<double> z;
  for (Local i = 0; i < map.owned; ++i)
    for (std::size_t k = 0; k < per_entity; ++k)
      z.push_back(all[std::size_t(map.original[i]) * per_entity + k]);
  return z;
}

template<class Set>
std::vector<double> multipliers(const Cloth& cloth) {
  if (std::is_same_v<Set, MetricSet>) return numbers_of(cloth.mesh.vertices, 2);
  std::vector<double> z = numbers_of(cloth.mesh.edges, 1);
  if (std::is_same_v<Set, EdgeSet>) return z;
  const std::vector<double> of_metric = numbers_of(cloth.mesh.vertices, 2);
  z.insert(z.end(), of_metric.begin(), of_metric.end());
  return z;
}

/// What contact takes in its place.
template<class Set>
using WithContact = std::conditional_t<std::is_same_v<Set, EdgeSet>, EdgeSet, BoundedSet<Set>>;

template<class Set>
const MakeMesh mesh_for = std::is_same_v<Set, MixedSet> ? quads_and_triangles : triangle_mesh;

constexpr auto all_edges = ConstrainedEdges::all;

double dot(std::span<const double> a, std::span<const double> b) {
  double sum = 0;
  for (std::size_t k = 0; k < a.size(); ++k) sum += a[k] * b[k];
  return sum_over(world, sum);
}

/// A cloth away from its rest shape, and a set that holds it there.
template<class Set>
struct Strained {
  Cloth cloth;
  Set set;
  State start;
  Candidate candidate;
  std::vector<Vec3> x, u;

  explicit Strained(DistributedMesh mesh)
      : cloth(make_cloth(std::move(mesh), config::Material{})),
        set(cloth, config::Inextensibility{}, ConstraintUse::with_contact) {
    const IndexMap& vertices = cloth.mesh.vertices;
    x = local(vertices, random_vectors(vertices.total, 0.1, 1));
    u = local(vertices, random_vectors(vertices.total, 1, 2));
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += cloth.mesh.rest_positions[i];
    start.positions = x;
    start.multipliers.force_density.assign(cloth.mesh.edges.size(), 0.0);
    start.multipliers.stress.assign(x.size(), Vec2::Zero());
    candidate.reset_for(start);
    set.start(start, dt, Freedom(x.size()), candidate);
    set.evaluate(x);
  }

  std::vector<double> change_of_rows() {
    std::vector<double> rows(set.rows(), 0.0);
    set.subtract_difference(u, rows);
    for (double& r : rows) r = -r;
    return rows;
  }

  std::vector<Vec3> spread(std::span<const double> z) {
    std::vector<Vec3> field(x.size(), Vec3::Zero());
    set.begin_spread(z);
    set.end_spread(field);
    for (Vec3& f : field) f = -f;
    return field;
  }
};

template<class Set>
class ConstraintSets : public testing::Test {};
using Sets = testing::Types<EdgeSet, MetricSet, MixedSet>;
TYPED_TEST_SUITE(ConstraintSets, Sets);

} // namespace

TYPED_TEST(ConstraintSets, DifferenceIsTheDerivativeOfTheValues) {
  on_odd_partitions(
      mesh_for<TypeParam>,
      [](DistributedMesh mesh) {
        Strained<TypeParam> t(std::move(mesh));
        constexpr double epsilon = 1e-6;
        std::vector<Vec3> ahead = t.x, behind = t.x;
        for (std::size_t i = 0; i < t.x.size(); ++i)
          ahead[i] += epsilon * t.u[i], behind[i] -= epsilon * t.u[i];
        const auto c1 = values<TypeParam>(t.cloth, ahead), c0 = values<TypeParam>(t.cloth, behind);
        const auto rows = t.change_of_rows();
        ASSERT_EQ(rows.size(), c1.size());
        for (std::size_t r = 0; r < rows.size(); ++r)
          EXPECT_NEAR(rows[r], (c1[r] - c0[r]) / (2 * epsilon), 1e-7) << r;
      },
      all_edges);
}

TYPED_TEST(ConstraintSets, SpreadIsTheAdjointOfDifference) {
  on_odd_partitions(
      mesh_for<TypeParam>,
      [](DistributedMesh mesh) {
        Strained<TypeParam> t(std::move(mesh));
        const auto z = multipliers<TypeParam>(t.cloth);
        const double by_rows = dot(z, t.change_of_rows());
        const auto field = t.spread(z);
        double by_vertices = 0;
        for (Local i = 0; i < t.cloth.mesh.vertices.owned; ++i) by_vertices += field[i].dot(t.u[i]);
        by_vertices = sum_over(world, by_vertices);
        EXPECT_NEAR(by_rows, by_vertices, 1e-12 * (1 + std::abs(by_rows)));
      },
      all_edges);
}

TYPED_TEST(ConstraintSets, SpreadIsTheSameOnAnyPartition) {
  Strained<TypeParam> whole(serial(mesh_for<TypeParam>, all_edges));
  const auto expected =
      gather<Vec3>(self, whole.cloth.mesh.vertices, whole.spread(multipliers<TypeParam>(whole.cloth)));
  on_odd_partitions(
      mesh_for<TypeParam>,
      [&](DistributedMesh mesh) {
        Strained<TypeParam> t(std::move(mesh));
        const auto found =
            gather<Vec3>(world, t.cloth.mesh.vertices, t.spread(multipliers<TypeParam>(t.cloth)));
        EXPECT_LT(relative_error(found, expected), 1e-14);
      },
      all_edges);
}

TYPED_TEST(ConstraintSets, PreconditionIsPositive) {
  on_odd_partitions(
      mesh_for<TypeParam>,
      [](DistributedMesh mesh) {
        Strained<TypeParam> t(std::move(mesh));
        const auto r = multipliers<TypeParam>(t.cloth);
        std::vector<double> s(r.size());
        t.set.factor(t.set.inverse_mass());
        t.set.precondition(r, s);
        EXPECT_GT(dot(r, s), 0);
      },
      all_edges);
}

// As between vertices of a flat sheet that slide across it: without a compliance of their own such rows would
// make programs singular.
TYPED_TEST(ConstraintSets, HaveAComplianceWhereNothingCanMove) {
  const auto grid = [](MPI_Comm comm) {
    return make_grid(comm, {0.8, 0.6}, {9, 7}, GridCells::alternating_triangles);
  };
  on_odd_partitions(grid, [&](DistributedMesh mesh) {
    Strained<TypeParam> t(std::move(mesh));
    t.x = t.start.positions = t.cloth.mesh.rest_positions;
    Freedom freedom(t.x.size());
    const auto compliances = [&] {
      t.set.start(t.start, dt, freedom, t.candidate);
      t.set.evaluate(t.x);
      return t.set.program_compliance();
    };
    if (!std::is_same_v<TypeParam, MixedSet>) { // of its rows some have no constraint
      for (const double a : compliances()) EXPECT_EQ(a, 0.0);
    }
    for (std::size_t v = 0; v < t.x.size(); ++v) freedom.keep_on_line(Local(v), Vec3::UnitZ());
    for (const double a : compliances()) EXPECT_EQ(a, 1.0);
  });
}

// The motion of its neighbours changes the averages at a held corner. Without a compliance there what
// preconditions programs is singular, and a sleeve that hung by its rim was thrown apart.
TEST(MetricSet, HeldCornersYieldByTheirNeighbours) {
  on_odd_partitions(triangle_mesh, [](DistributedMesh mesh) {
    const Cloth cloth = make_cloth(std::move(mesh), config::Material{});
    config::Inextensibility options;
    options.compliance = 1e-5;
    for (const auto use : {ConstraintUse::alone, ConstraintUse::with_contact, ConstraintUse::in_newton}) {
      MetricSet set(cloth, options, use);
      State start;
      start.positions = cloth.mesh.rest_positions;
      start.multipliers.stress.assign(start.positions.size(), Vec2::Zero());
      Freedom freedom(start.positions.size());
      for (std::size_t v = 0; v < start.positions.size(); ++v)
        if (cloth.mesh.vertices.original[v] % 2 == 0) freedom.hold(Local(v));
      set.start(start, dt, freedom, Candidate{});
      set.evaluate(start.positions);
      for (const double a : set.program_compliance()) EXPECT_GT(a, 0.0);
    }
  });
}

// A sheet of triangles thrown against a ball: whatever the set keeps, it ends within the limit and meets
// nothing.
TYPED_TEST(ConstraintSets, AreKeptWhereContactsPress) {
  const Case input = read_case(R"(
cloth: {grid: {size: [0.8, 0.6], vertices: [9, 7], cells: alternating_triangles}, start: {translate: [-0.4, -0.3, 0.02]}}
obstacles: [{sphere: {centre: [0, 0, -0.2], radius: 0.2}}]
contact: {thickness: 5 mm}
)",
                               "case.yaml");
  const auto grid = [](MPI_Comm comm) {
    return std::is_same_v<TypeParam, MixedSet>
               ? quads_and_triangles(comm)
               : make_grid(comm, {0.8, 0.6}, {9, 7}, GridCells::alternating_triangles);
  };
  on_odd_partitions(
      grid,
      [&](DistributedMesh mesh) {
        const Cloth cloth = make_cloth(std::move(mesh), input.cloths[0].material);
        const Obstacles obstacles(world, input);
        ContactProjectionOptions options{
            .limits = input.inextensibility, .contact = *input.contact, .gravity = 9.81, .longest_step = dt};
        options.limits.compliance = 1e-5;
        ContactProjection<WithContact<TypeParam>> filter(cloth, obstacles, Thickness(cloth, input), options);
        State start;
        start.positions = cloth.mesh.rest_positions;
        for (Vec3& x : start.positions) x += Vec3(-0.4, -0.3, 0.02);
        start.velocities.assign(start.positions.size(), Vec3(0, 0, -3));
        start.multipliers.force_density.assign(cloth.mesh.edges.size(), 0.0);
        start.multipliers.projection_tension.assign(cloth.mesh.edges.size(), 0.0);
        start.multipliers.stress.assign(start.positions.size(), Vec2::Zero());
        start.multipliers.carried_contact_force.assign(start.positions.size(), Vec3::Zero());
        start.reported.contact_force.assign(cloth.mesh.vertices.owned, Vec3::Zero());
        Candidate candidate;
        candidate.reset_for(start);
        candidate.velocities = start.velocities;
        const FilterReport report = filter.apply(start, dt, Freedom(start.positions.size()), candidate);
        EXPECT_EQ(report.failure, "");
        EXPECT_GT(report.contacts, 0);
        std::vector<Vec3> x = start.positions, bodies;
        for (std::size_t i = 0; i < x.size(); ++i) x[i] += dt * candidate.velocities[i];
        obstacles.place(dt, bodies);
        WithContact<TypeParam> set(cloth, options.limits);
        EXPECT_LE(set.strain(x), options.limits.strain);
        Intersections test(cloth, obstacles);
        EXPECT_EQ(sum_over(world, Global(test.find(x, bodies).size())), 0);
      },
      all_edges);
}
