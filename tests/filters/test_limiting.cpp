// Edge colours, strain limiting, XPBD and springs.
#include "partition/edge_colours.hpp"
#include "src/filters/edge_sweeps.hpp"
#include "src/forces/springs.hpp"
#include "tests/force_bed.hpp"
#include "tests/throw.hpp"

using namespace taut;
using namespace taut::test;
using enum config::InextensibilityMethod;

namespace {

constexpr auto cg = config::LinearSolver::cg;

MeshSlab sheet(MPI_Comm comm) { return make_grid(comm, {0.8, 0.6}, {9, 7}); }

/// The colour of each edge by original number, checking that all ranks that have the edge agree.
Column colours_of(const DistributedMesh& mesh) {
  const EdgeColours colours = colour_edges(mesh);
  Column largest = Column::Constant(mesh.edges.total, -1),
         smallest = -Column::Constant(mesh.edges.total, 1000);
  for (std::size_t c = 0; c < colours.edges.size(); ++c)
    for (const Local e : colours.edges[c]) {
      largest[mesh.edges.original[e]] = double(c);
      smallest[mesh.edges.original[e]] = -double(c);
    }
  max_in_place(mesh.comm, {largest.data(), std::size_t(largest.size())});
  max_in_place(mesh.comm, {smallest.data(), std::size_t(smallest.size())});
  EXPECT_EQ(largest, Column(-smallest));
  return largest;
}

} // namespace

TEST(EdgeColours, AreProperAndTheSameForAnyPartition) {
  for (const MakeMesh& make : {MakeMesh(mixed_mesh), MakeMesh(sheet)}) {
    const DistributedMesh whole = serial(make);
    const Column expected = colours_of(whole);
    for (Local v = 0; v < whole.vertices.owned; ++v)
      for (const EdgeEnd& a : whole.star_of(v))
        for (const EdgeEnd& b : whole.star_of(v))
          if (a.edge != b.edge) {
            EXPECT_NE(expected[whole.edges.original[a.edge]], expected[whole.edges.original[b.edge]]);
          }
    EXPECT_GE(expected.minCoeff(), 0);
    EXPECT_LE(expected.maxCoeff(), 6); // 4 edges at a vertex: 6 neighbours at most
    on_odd_partitions(make, [&](const DistributedMesh& mesh) { EXPECT_EQ(colours_of(mesh), expected); });
  }
}

namespace {

Vec3 rest_of(Global v) { return {0.1 * double(v % 9), 0.1 * double(v / 9), 0}; }

std::optional<Vec3> disturbed(Global v) {
  static const auto noise = random_vectors(63, 0.02, 8);
  if (v == 0 || v == 62) return std::nullopt;
  return Vec3(rest_of(v) + noise[v]);
}

std::optional<Vec3> all_disturbed(Global v) {
  return rest_of(v) + (v == 0 ? Vec3(0.03, 0, 0.05) : Vec3(disturbed(v).value_or(rest_of(v))));
}

} // namespace

TEST(StrainLimiting, ReachesTheLimitToTheSameBitAtAnyRankCount) {
  for (const auto m : {jacobi, gauss_seidel}) {
    const auto how = method(m, cg, 1e-3);
    Thrown alone(serial(sheet), rest_of, disturbed);
    const FilterReport expected = alone.apply(how);
    const Column end = alone.end();
    const Column tension =
        gather<double>(self, alone.cloth.mesh.edges, alone.candidate.multipliers.force_density);
    on_odd_partitions(sheet, [&](DistributedMesh mesh) {
      Thrown t(std::move(mesh), rest_of, disturbed);
      EXPECT_GT(t.strain(), 0.1);
      const FilterReport report = t.apply(how);
      EXPECT_EQ(report.failure, "");
      EXPECT_EQ(report.iterations, expected.iterations);
      EXPECT_LE(t.strain(), 1e-3);
      EXPECT_EQ(t.end(), end);
      EXPECT_EQ(gather<double>(world, t.cloth.mesh.edges, t.candidate.multipliers.force_density), tension);
    });
  }
}

TEST(StrainLimiting, JacobiTakesMoreSweepsThanGaussSeidel) {
  Thrown a(serial(sheet), rest_of, disturbed), b(serial(sheet), rest_of, disturbed);
  EXPECT_GT(a.apply(method(jacobi, cg, 1e-3)).iterations,
            2 * b.apply(method(gauss_seidel, cg, 1e-3)).iterations);
}

TEST(StrainLimiting, KeepsMomentum) {
  for (const auto m : {jacobi, gauss_seidel}) {
    Thrown t(serial(sheet), rest_of, all_disturbed);
    const auto momentum = [&] {
      Vec3 sum = Vec3::Zero();
      for (std::size_t i = 0; i < t.cloth.mass.size(); ++i)
        sum += t.cloth.mass[i] * t.candidate.velocities[i];
      return sum;
    };
    const Vec3 before = momentum();
    EXPECT_EQ(t.apply(method(m, cg, 1e-3)).failure, "");
    EXPECT_LT((momentum() - before).norm(), 1e-13);
  }
}

TEST(StrainLimiting, AcceptsWhatABudgetLeavesOnlyIfToldTo) {
  for (const bool must_reach_limit : {true, false})
    on_odd_partitions(sheet, [&](DistributedMesh mesh) {
      auto how = method(gauss_seidel, cg, 1e-4);
      how.limiting = config::Limiting{.max_sweeps = 3, .must_reach_limit = must_reach_limit};
      Thrown t(std::move(mesh), rest_of, disturbed);
      const FilterReport report = t.apply(how);
      EXPECT_EQ(report.iterations, 3);
      EXPECT_EQ(report.failure.find("strain limiting left a strain of ") == 0, must_reach_limit);
      EXPECT_GT(t.strain(), 1e-4);
    });
}

// Pulled along itself by an impulse, an edge answers with a tension that takes away half of it from each end.
TEST(StrainLimiting, ReportsTheTensionThatItApplied) {
  const auto dumbbell = [](MPI_Comm comm) { return make_line(comm, 0.1, 2); };
  constexpr double stretch = 1e-3;
  for (const auto m : {jacobi, gauss_seidel}) {
    Thrown t(
        serial(dumbbell), [](Global v) { return Vec3(0.1 * double(v), 0, 0); },
        [](Global v) { return std::optional(Vec3(0.1 * (1 + stretch) * double(v), 0, 0)); });
    EXPECT_EQ(t.apply(method(m, cg, 1e-12)).failure, "");
    const double tension = t.candidate.multipliers.force_density[0] * 0.1;
    EXPECT_NEAR(tension * t.dt * t.dt / t.cloth.mass[0], 0.1 * stretch / 2, 1e-12);
  }
}

// A sweep from s = 0 over one edge: h^2 T (w_a + w_b + l c/h^2) = |d| - l [Macklin et al. 2016, eq. 18].
TEST(EdgeSweeps, StretchAnEdgeByItsCompliance) {
  const auto dumbbell = [](MPI_Comm comm) { return make_line(comm, 0.1, 2); };
  const Cloth cloth = make_cloth(serial(dumbbell), config::Material{});
  EdgeSweeps sweeps(cloth);
  constexpr double h = 0.01, c = 2e-3, l = 0.1;
  const std::vector<char> prescribed{1, 0};
  sweeps.start(h, c, Freedom(prescribed));
  std::vector<Vec3> x{{0, 0, 0}, {0, 0.13, 0}};
  std::vector<double> s{0};
  for (int n = 0; n < 3; ++n) { // the first one brings it there, the others leave it
    sweeps.gauss_seidel(x, s);
    const double w = 1 / cloth.mass[1], a = l * c / (h * h);
    EXPECT_NEAR(s[0], 0.03 / (w + a), 1e-15);
    EXPECT_NEAR(x[1][1], 0.13 - w * s[0], 1e-15);
    EXPECT_NEAR(x[1][1] / l - 1, c * s[0] / (h * h), 1e-12); // strain = compliance * tension
  }
}

namespace {

std::unique_ptr<Force> springs_of(const Bed& b) {
  return std::make_unique<Springs>(b.cloth, b.pattern, 300, 0.0);
}

constexpr double step = 1e-6; // m

Column force_of(const Bed& bed, const WholeState& state) {
  StepSystem system(bed.pattern, bed.cloth.mesh.vertices.size());
  system.start(1.0);
  springs_of(bed)->add_to(system, bed.at(state));
  return whole_rhs(bed, system);
}

/// All edges longer than at rest, so that nothing of the Hessian is left out.
WholeState stretched(const Bed& whole) {
  WholeState state = random_state(whole, 3);
  const auto noise = random_vectors(Global(state.positions.size()), 0.03, 4);
  for (Local i = 0; i < whole.cloth.mesh.vertices.owned; ++i) {
    const Global v = whole.cloth.mesh.vertices.original[i];
    state.positions[v] = 1.6 * whole.cloth.mesh.rest_positions[i] + noise[v];
  }
  return state;
}

using SpringForce = OnABed;

} // namespace

TEST_F(SpringForce, IsTheGradientOfItsEnergyAndItsStiffnessTheHessian) {
  const WholeState state = stretched(whole_);
  for (Local e = 0; e < whole_.cloth.mesh.edges.owned; ++e)
    ASSERT_GT(strain_of(whole_.cloth, whole_.at(state).positions, e), 0);
  const Global n = 3 * Global(state.positions.size());
  Column gradient(n);
  Dense hessian(n, n);
  for (Global c = 0; c < n; ++c) {
    WholeState plus = state, minus = state;
    plus.positions[c / 3][c % 3] += step;
    minus.positions[c / 3][c % 3] -= step;
    const auto force = springs_of(whole_);
    gradient[c] = (force->energy(whole_.at(plus)) - force->energy(whole_.at(minus))) / (2 * step);
    hessian.col(c) = -(force_of(whole_, plus) - force_of(whole_, minus)) / (2 * step);
  }
  EXPECT_LT(relative_error(force_of(whole_, state), -gradient), 1e-6);
  EXPECT_LT(relative_error(step_of(whole_, springs_of, state, 1.0).matrix, hessian), 1e-6);
}

TEST_F(SpringForce, IsStiffWithoutNegativeDirectionsAndSharedOut) {
  for (unsigned seed = 0; seed < 3; ++seed) {
    const WholeState state = random_state(whole_, seed); // some edges shorter than at rest
    const auto expected = step_of(whole_, springs_of, state, 1.0);
    const Column eigenvalues =
        Eigen::SelfAdjointEigenSolver<Dense>(expected.matrix, Eigen::EigenvaluesOnly).eigenvalues();
    EXPECT_GT(eigenvalues[0], -1e-12 * eigenvalues[eigenvalues.size() - 1]);
    const double energy = springs_of(whole_)->energy(whole_.at(state));
    on_odd_partitions(mixed_mesh, [&](DistributedMesh mesh) {
      const Bed bed(std::move(mesh));
      const auto found = step_of(bed, springs_of, state, 1.0);
      EXPECT_LT(relative_error(found.matrix, expected.matrix), 1e-12);
      EXPECT_LT(relative_error(found.rhs, expected.rhs), 1e-12);
      EXPECT_NEAR(sum_over(world, springs_of(bed)->energy(bed.at(state))), energy, 1e-12 * energy);
    });
  }
}
