#include "tests/force_bed.hpp"

#include <numbers>

using namespace taut;
using namespace taut::test;

using Loads = OnABed;

TEST(Bending, CurvatureIsTheSecondDerivative) {
  constexpr double l1 = 0.3, l2 = 0.5;
  const auto w = curvature_weights(l1, l2);
  const auto apply = [&](auto f) { return w[0] * f(-l1) + w[1] * f(0.0) + w[2] * f(l2); };
  EXPECT_NEAR(apply([](double) { return 1.0; }), 0, round_off);
  EXPECT_NEAR(apply([](double s) { return s; }), 0, round_off);
  EXPECT_NEAR(apply([](double s) { return s * s; }), 2, 10 * round_off);
}

TEST_F(Loads, EnergyOfBendingFollowsItsFormula) {
  const DistributedMesh& mesh = whole_.cloth.mesh;
  const State state = whole_.at(state_);
  double expected = 0;
  for (const auto& [b, c, a] : mesh.triples) {
    const double l1 = (mesh.rest_positions[c] - mesh.rest_positions[b]).norm();
    const double l2 = (mesh.rest_positions[a] - mesh.rest_positions[c]).norm();
    const Vec3 one = (state.positions[c] - state.positions[b]) / l1,
               two = (state.positions[a] - state.positions[c]) / l2;
    expected += material.bending / 2 * (2 / (l1 + l2) * (two - one)).squaredNorm() * whole_.cloth.measure[c];
  }
  EXPECT_NEAR(bending(whole_)->energy(state), expected, round_off * expected);
}

TEST(Bending, OfACylinderIsHalfBKappaSquaredPerArea) {
  constexpr double radius = 0.3, height = 0.2;
  for (const Global around : {40, 80}) { // closed, so that every vertex is bent
    const Global rows = 4;
    std::vector<Vec3> points;
    std::vector<Cell> cells;
    for (Global i = 0; i < rows * around; ++i) {
      const double angle = 2 * std::numbers::pi * double(i % around) / double(around);
      points.emplace_back(radius * std::cos(angle), radius * std::sin(angle),
                          height * double(i / around) / (rows - 1));
    }
    for (Global row = 0; row + 1 < rows; ++row)
      for (Global k = 0; k < around; ++k) {
        const Global a = row * around + k, b = row * around + (k + 1) % around;
        cells.push_back({{a, b, b + around, a + around}});
      }
    const auto mesh = [&](MPI_Comm comm) { return slab_of_whole(comm, points, cells); };
    const double edge_over_radius = 2 * std::sin(std::numbers::pi / double(around)); // chord d over R
    const double expected = material.bending / 2 / (radius * radius) * 2 * std::numbers::pi * radius * height;
    on_odd_partitions(mesh, [&](DistributedMesh distributed) {
      const Bed bed(std::move(distributed));
      const double energy =
          sum_over(world, bending(bed)->energy({.positions = bed.cloth.mesh.rest_positions}));
      // The curvature of three points at chords d on a circle is 1/R exactly; the area of the chords falls
      // short by (d/R)^2 / 24.
      EXPECT_NEAR(energy / expected, 1, edge_over_radius * edge_over_radius / 20);
      EXPECT_NE(energy, 0);
    });
  }
}

TEST_F(Loads, DampingOfYarnsIsProportionalToTheStiffness) {
  constexpr double h = 0.013;
  EXPECT_LT(relative_error(step_of(whole_, damped_bending, state_, h).matrix,
                           (h * h + h * beta) * step_of(whole_, bending, state_, 1.0).matrix),
            10 * round_off);
}

TEST_F(Loads, AirDragFollowsItsFormula) {
  const IndexMap& map = whole_.cloth.mesh.vertices;
  Column expected = Column::Zero(3 * map.total), velocities(3 * map.total);
  for (Global i = 0; i < map.total; ++i) velocities.segment<3>(3 * i) = state_.velocities[i];
  for (const LocalCell& cell : whole_.cloth.mesh.cells) {
    const int n = cell.size();
    if (n == 2) continue;
    Vec3 centre = Vec3::Zero(), velocity = Vec3::Zero(), area = Vec3::Zero();
    std::array<Vec3, 4> x;
    for (int k = 0; k < n; ++k) {
      const Global v = map.original[cell.vertices[k]];
      x[k] = state_.positions[v];
      centre += x[k] / n;
      velocity += state_.velocities[v] / n;
    }
    for (int k = 0; k < n; ++k) area += 0.5 * x[k].cross(x[(k + 1) % n]); // of any closed polygon
    const Vec3 normal = area.normalized(), along = air.wind.normalized();
    const double phase =
        2 * std::numbers::pi * (centre.dot(along) / air.gust.length - state_time / air.gust.period);
    const double u = (velocity - air.wind - air.gust.speed * std::sin(phase) * along).dot(normal);
    for (int k = 0; k < n; ++k)
      expected.segment<3>(3 * map.original[cell.vertices[k]]) -=
          air.density * air.drag * area.norm() / 2 * std::abs(u) * u * normal / n;
  }
  on_odd_partitions(mixed_mesh, [&](DistributedMesh mesh) {
    const Bed bed(std::move(mesh));
    const Step step = step_of(bed, drag, state_, 1.0); // f(v) = f(0) - D v
    EXPECT_LT(relative_error(step.rhs - step.matrix * velocities, expected), round_off);
  });
}

TEST_F(Loads, CarriedTensionIsALaplacian) {
  const DistributedMesh& mesh = whole_.cloth.mesh;
  const Global n = mesh.vertices.total;
  Dense expected = Dense::Zero(3 * n, 3 * n), pushes = expected;
  for (Local e = 0; e < mesh.edges.owned; ++e) {
    const Global a = mesh.vertices.original[mesh.edge_vertices[e][0]];
    const Global b = mesh.vertices.original[mesh.edge_vertices[e][1]];
    const double q = state_.force_density[mesh.edges.original[e]];
    for (int k = 0; k < 3; ++k) {
      const Column ends = Column::Unit(3 * n, 3 * a + k) - Column::Unit(3 * n, 3 * b + k);
      (q > 0 ? expected : pushes) += q * ends * ends.transpose();
    }
  }
  Column x(3 * n);
  for (Global i = 0; i < n; ++i) x.segment<3>(3 * i) = state_.positions[i];
  on_odd_partitions(mixed_mesh, [&](DistributedMesh distributed) {
    const Bed bed(std::move(distributed));
    const Step step = step_of(bed, tension, state_, 1.0);
    EXPECT_LT(relative_error(step.matrix, expected), round_off);
    EXPECT_LT(relative_error(step.rhs, -expected * x), round_off);
    const Step whole = step_of(bed, tension_and_pushes, state_, 1.0);
    EXPECT_LT(relative_error(whole.matrix, expected), round_off);
    EXPECT_LT(relative_error(whole.rhs, -(expected + pushes) * x), round_off);
  });
}

TEST(Gravity, IsThatOfTheEndOfTheStep) {
  const Bed bed(serial([](MPI_Comm comm) { return make_grid(comm, {0.8, 0.6}, {3, 3}); }));
  config::Gravity turning;
  turning.keyframes = {{0, {0, 0, -8}}, {2, {0, 0, 8}}};
  State state{.time = 0.5, .positions = bed.cloth.mesh.rest_positions};
  for (Vec3& x : state.positions) x[2] = 2;
  StepSystem system(bed.pattern, bed.cloth.mesh.vertices.size());
  system.start(1.0);
  Gravity gravity(bed.cloth, turning);
  gravity.add_to(system, state);
  Vec3 force = Vec3::Zero();
  for (const Vec3& f : system.rhs()) force += f;
  const double mass = material.density * 0.8 * 0.6;
  EXPECT_LT((force - mass * Vec3(0, 0, 4)).norm(), round_off); // at 1.5 s
  EXPECT_NEAR(gravity.energy(state), mass * 4 * 2, round_off); // at 0.5 s
}

TEST(Gravity, BearsTheWholeWeightOnce) {
  constexpr double area = 0.8 * 0.6;
  const auto grid = [](MPI_Comm comm) { return make_grid(comm, {0.8, 0.6}, {9, 7}); };
  on_odd_partitions(grid, [&](DistributedMesh mesh) {
    const Bed bed(std::move(mesh));
    const State rest{.positions = bed.cloth.mesh.rest_positions};
    StepSystem system(bed.pattern, bed.cloth.mesh.vertices.size());
    system.start(1.0);
    gravity(bed)->add_to(system, rest);
    const Column force = whole_rhs(bed, system);
    const Vec3 weight = material.density * area * oblique_gravity;
    EXPECT_LT((force.reshaped(3, force.size() / 3).rowwise().sum() - weight).norm(),
              round_off * weight.norm());
    const double energy = sum_over(world, gravity(bed)->energy(rest));
    EXPECT_NEAR(energy, -weight.dot(Vec3(0.4, 0.3, 0)), round_off * weight.norm());
  });
}
