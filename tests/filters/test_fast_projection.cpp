#include "src/constraints/strain_gauge.hpp"
#include "src/filters/fast_projection.hpp"
#include "tests/petsc_options.hpp"
#include "tests/support.hpp"

#include <gtest/gtest.h>

#include <numbers>

using namespace taut;
using namespace taut::test;

namespace {

constexpr double dt = 0.01;         // s
constexpr double limit = 1e-3;      // strain
constexpr double round_off = 1e-14; // relative to the sum of the sizes of what is added

MeshSlab grid(MPI_Comm comm) { return make_grid(comm, {0.8, 0.6}, {9, 7}); }
MeshSlab dumbbell(MPI_Comm comm) { return make_line(comm, 0.1, 2); }

config::Inextensibility options(config::LinearSolver solver) {
  config::Inextensibility options;
  options.strain = limit;
  options.solver = solver;
  options.compliance = 0;
  return options;
}

constexpr auto cg = config::LinearSolver::cg, mumps = config::LinearSolver::mumps;

/// A cloth in its rest shape, about to be torn out of it.
struct Throw {
  Cloth cloth;
  State start;
  Candidate candidate;
  std::vector<char> prescribed;

  Throw(DistributedMesh mesh, const std::function<Vec3(Global)>& velocity)
      : cloth(make_cloth(std::move(mesh), config::Material{})) {
    const IndexMap& map = cloth.mesh.vertices;
    start.positions = cloth.mesh.rest_positions;
    for (const Global v : map.original) candidate.velocities.push_back(velocity(v));
    candidate.multipliers.force_density.assign(cloth.mesh.edges.size(), 0.0);
    prescribed.assign(map.size(), 0);
  }

  std::vector<Vec3> end() const {
    std::vector<Vec3> x = start.positions;
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += dt * candidate.velocities[i];
    return x;
  }

  FilterReport project(const config::Inextensibility& how) {
    return FastProjection<EdgeSet>(cloth, how).apply(start, dt, Freedom(prescribed), candidate);
  }

  /// Over all ranks.
  Vec3 sum(const std::function<Vec3(Local)>& term) const {
    Vec3 sum = Vec3::Zero();
    for (Local i = 0; i < cloth.mesh.vertices.owned; ++i) sum += cloth.mass[i] * term(i);
    sum_in_place(cloth.mesh.comm, {sum.data(), 3});
    return sum;
  }
  double scale(const std::function<Vec3(Local)>& term) const {
    return sum([&](Local i) { return Vec3(term(i).norm(), 0, 0); })[0];
  }
};

/// Moves vertices by up to 3 cm an axis in the step, the edges being 10 cm long.
Vec3 disturbance(Global vertex) {
  static const auto velocities = random_vectors(63, 3.0, 8);
  return velocities[vertex];
}

} // namespace

TEST(FastProjection, BringsStrainWithinTheLimitAndLeavesPins) {
  for (const auto solver : {cg, mumps})
    on_odd_partitions(grid, [&](DistributedMesh mesh) {
      Throw t(std::move(mesh), disturbance);
      const IndexMap& map = t.cloth.mesh.vertices;
      for (Local i = 0; i < map.size(); ++i) {
        t.prescribed[i] = map.original[i] == 0 || map.original[i] == 8 || map.original[i] == 40;
        if (t.prescribed[i]) t.candidate.velocities[i] = Vec3(0, 0, 0.5);
      }
      EXPECT_GT(measure_strain(t.cloth, t.end()).max, 0.1);
      EXPECT_EQ(t.project(options(solver)).failure, "");
      EXPECT_LE(measure_strain(t.cloth, t.end()).max, limit);
      for (Local i = 0; i < map.size(); ++i)
        if (t.prescribed[i]) {
          EXPECT_EQ(t.candidate.velocities[i], Vec3(0, 0, 0.5));
        }
    });
}

TEST(FastProjection, SaysSoIfItDoesNotGetThere) {
  on_odd_partitions(grid, [&](DistributedMesh mesh) {
    Throw t(std::move(mesh), disturbance);
    config::Inextensibility one = options(cg);
    one.max_iterations = 1;
    const FilterReport report = t.project(one);
    EXPECT_NE(report.failure, "");
    EXPECT_EQ(report.iterations, 1);
  });
}

// The forces of an edge on its two ends are opposite numbers, whatever mu is.
TEST(FastProjection, KeepsLinearMomentumHoweverSloppyTheSolver) {
  for (const char* tolerance : {"1e-2", "0.5"}) {
    const OptionsInForce sloppy(std::vector{PetscSetting{"-projection_ksp_rtol", tolerance}});
    on_odd_partitions(grid, [&](DistributedMesh mesh) {
      Throw t(std::move(mesh), disturbance);
      const auto momentum = [&](Local i) { return t.candidate.velocities[i]; };
      const Vec3 before = t.sum(momentum);
      const double scale = t.scale(momentum);
      t.project(options(cg));
      EXPECT_LE((t.sum(momentum) - before).norm(), round_off * scale);
    });
  }
}

// Each correction pulls along the edges as they lie when it is made.
TEST(FastProjection, CorrectionExertsNoTorque) {
  on_odd_partitions(grid, [&](DistributedMesh mesh) {
    Throw t(std::move(mesh), disturbance);
    config::Inextensibility one = options(cg);
    one.max_iterations = 1;
    const std::vector<Vec3> x = t.end(), v = t.candidate.velocities;
    t.project(one);
    const auto torque = [&](Local i) { return Vec3(x[i].cross(t.candidate.velocities[i] - v[i])); };
    EXPECT_GT(t.scale(torque), 1e-3);
    EXPECT_LE(t.sum(torque).norm(), round_off * t.scale(torque));
  });
}

// On a dumbbell all corrections pull along the end edge, so that sum m x_end x (v_end - v_start) = 0; with
// x_end = x_start + h v_end: L_end = L_start + h sum m v_end x v_start.
TEST(FastProjection, ChangesTheAngularMomentumOfADumbbellAsItMust) {
  const auto velocity = [](Global v) { return v == 0 ? Vec3(1, -0.5, 0.3) : Vec3(2, 1.5, -3); };
  on_odd_partitions(dumbbell, [&](DistributedMesh mesh) {
    Throw t(std::move(mesh), velocity);
    const std::vector<Vec3> v = t.candidate.velocities;
    EXPECT_EQ(t.project(options(cg)).failure, "");
    const std::vector<Vec3> x = t.end();
    const auto gain = [&](Local i) {
      const Vec3& v_end = t.candidate.velocities[i];
      return Vec3(x[i].cross(v_end) - t.start.positions[i].cross(v[i]) - dt * v_end.cross(v[i]));
    };
    const auto size = [&](Local i) { return Vec3(x[i].cross(t.candidate.velocities[i])); };
    EXPECT_LE(t.sum(gain).norm(), round_off * t.scale(size));
  });
}

// Pulled along itself, an edge needs the tension that takes away the surplus of momentum. With gradients 2
// |d|/l in every correction, mu and the impulse differ by the mean strain while it is corrected.
TEST(FastProjection, ReportsTheTensionThatItApplied) {
  constexpr double stretch = 1e-2, length = 0.1;
  const auto velocity = [](Global v) { return v == 0 ? Vec3(0, 0, 0) : Vec3(stretch * length / dt, 0, 0); };
  on_odd_partitions(dumbbell, [&](DistributedMesh mesh) {
    Throw t(std::move(mesh), velocity);
    EXPECT_EQ(t.project(options(cg)).failure, "");
    const IndexMap& map = t.cloth.mesh.vertices;
    double impulse = 0, tension = 0;
    for (Local i = 0; i < map.owned; ++i)
      if (map.original[i] == 0) impulse = t.cloth.mass[i] * t.candidate.velocities[i][0];
    for (Local e = 0; e < t.cloth.mesh.edges.owned; ++e)
      tension = t.candidate.multipliers.force_density[e] * length;
    EXPECT_NEAR(sum_over(world, tension) * dt / sum_over(world, impulse), 1, 1.1 * stretch);
    const double mass = config::Material{}.density * length / 2, surplus = stretch * length / dt / 2;
    EXPECT_NEAR(sum_over(world, impulse) / (mass * surplus), 1,
                limit / stretch); // what strain is left is not paid for
  });
}

// A fifth of the stretch is left to an edge that yields a quarter of what its ends do.
TEST(FastProjection, StretchesAnEdgeByItsCompliance) {
  constexpr double stretch = 1e-2, length = 0.1;
  const auto velocity = [](Global v) { return v == 0 ? Vec3(0, 0, 0) : Vec3(stretch * length / dt, 0, 0); };
  on_odd_partitions(dumbbell, [&](DistributedMesh mesh) {
    Throw t(std::move(mesh), velocity);
    config::Inextensibility how = options(cg);
    how.strain = 0.5 * stretch;
    const double mass = config::Material{}.density * length / 2;
    how.compliance = 0.25 * (2 / mass) * dt * dt / length;
    EXPECT_EQ(t.project(how).failure, "");
    const DistributedMesh& m = t.cloth.mesh;
    std::vector<Vec3> x = t.end();
    m.vertex_halo.update(x);
    double tension = 0, strain = 0;
    for (Local e = 0; e < m.edges.owned; ++e) {
      tension = t.candidate.multipliers.force_density[e] * length;
      strain = (x[m.edge_vertices[e][1]] - x[m.edge_vertices[e][0]]).norm() / length - 1;
    }
    tension = sum_over(world, tension);
    strain = sum_over(world, strain);
    EXPECT_NEAR(strain / (*how.compliance * tension), 1,
                0.05); // one iteration, of second order in the stretch
    EXPECT_NEAR(strain / (stretch / 5), 1, 0.05);
  });
}

namespace {

/// The farthest that the projection moves a vertex of a sheet of length 1 rolled about a cylinder of radius
/// 0.4, with `n` edges around; each vertex lies at the angle `turn` from the one before.
double displacement_of_rolled_sheet(int n, double radius, double turn) {
  const auto sheet = [n](MPI_Comm comm) { return make_grid(comm, {1.0, 0.2}, {n + 1, 3}); };
  double farthest = 0;
  on_odd_partitions(sheet, [&](DistributedMesh mesh) {
    Throw t(std::move(mesh), [](Global) { return Vec3(0, 0, 0); });
    const IndexMap& map = t.cloth.mesh.vertices;
    for (Local i = 0; i < map.size(); ++i) {
      const double angle = turn * double(map.original[i] % (n + 1));
      t.start.positions[i] = {radius * std::sin(angle), t.start.positions[i][1],
                              radius * (1 - std::cos(angle))};
    }
    EXPECT_EQ(t.project(options(mumps)).failure, "");
    for (Local i = 0; i < map.owned; ++i)
      farthest = std::max(farthest, dt * t.candidate.velocities[i].norm());
  });
  return max_over(world, farthest);
}

} // namespace

// On arcs as long as the edges, chords are too short by (d/R)^2/24: all edges together by that part of the
// length.
TEST(FastProjection, LeavesARolledSheetWhereItIs) {
  constexpr double radius = 0.4;
  const auto moved = [](int n) { return displacement_of_rolled_sheet(n, radius, 1.0 / n / radius); };
  const auto square = [](int n) { return 1.0 / n / radius / n / radius; };
  const double coarse = moved(20), fine = moved(40);
  EXPECT_LT(coarse, square(20) / 24);
  EXPECT_LT(fine, square(40) / 24);
  EXPECT_NEAR(coarse / fine, 4, 0.1);
}

TEST(FastProjection, LeavesAnIsometricSheetAlone) {
  constexpr double radius = 0.4;
  EXPECT_LT(displacement_of_rolled_sheet(20, radius, 2 * std::asin(0.5 / 20 / radius)), 1e-14);
}
