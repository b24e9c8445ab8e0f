#include "src/linear/velocity_system.hpp"
#include "tests/force_bed.hpp"
#include "tests/petsc_options.hpp"

using namespace taut;
using namespace taut::test;

namespace {

constexpr double dt = 0.02; // s: inertia and stiffness weigh alike

struct Solver {
  SolverOptions::Kind kind;
  std::vector<PetscSetting> options;
};

/// A step of the mixed cloth with some vertices prescribed, and its solution by dense elimination.
class VelocitySolve : public testing::Test {
protected:
  static constexpr double tolerance = 1e-12; // of CG
  static constexpr double accuracy = 1e-9;   // relative; CG's tolerance times the condition of some hundreds
  static bool prescribed(Global vertex) { return vertex % 7 == 3; }

  VelocitySolve() {
    const StepSystem system = full_step(whole_, state_, dt);
    const Dense a = gather(whole_.cloth.mesh, system.matrix());
    const Column b = whole_rhs(whole_, system);
    std::vector<Eigen::Index> free;
    expected_ = Column::Zero(b.size());
    for (Eigen::Index i = 0; i < b.size(); ++i)
      if (prescribed(i / 3))
        expected_[i] = state_.velocities[i / 3][i % 3];
      else
        free.push_back(i);
    const Column residual = b - a * expected_;
    const Column solved = Dense(a(free, free)).ldlt().solve(Column(residual(free)));
    expected_(free) = solved;
  }

  /// Solves on every odd partition and hands the report and the whole solution to `check`.
  template<class Check>
  void solve(const SolverOptions& options, const Check& check) const {
    on_odd_partitions(mixed_mesh, [&](DistributedMesh mesh) {
      const Bed bed(std::move(mesh));
      const IndexMap& map = bed.cloth.mesh.vertices;
      const StepSystem system = full_step(bed, state_, dt);
      std::vector<char> held;
      for (const Global v : map.original) held.push_back(prescribed(v));
      std::vector<Vec3> v = local(map, state_.velocities);
      VelocitySystem solver(bed.cloth.mesh, bed.pattern, options);
      const SolveReport report = solver.solve(system.matrix(), system.rhs(), held, tolerance, v);
      const Column found = gather<Vec3>(world, map, v);
      for (Local i = 0; i < map.size(); ++i) EXPECT_EQ(v[i], found.segment<3>(3 * map.original[i])); // ghosts
      check(report, found);
    });
  }

  const Bed whole_{serial(mixed_mesh)};
  const WholeState state_ = random_state(whole_, 0);
  Column expected_;
};

constexpr auto cg = SolverOptions::Kind::cg, mumps = SolverOptions::Kind::mumps;
const std::string pc = "-velocity_pc_type", format = "-velocity_mat_type";

} // namespace

TEST(RightHandSide, IsTheSameToTheLastBitOnAnyPartition) {
  const Bed whole(serial(mixed_mesh));
  for (unsigned seed = 0; seed < 5; ++seed) {
    const WholeState state = random_state(whole, seed);
    const Column expected = whole_rhs(whole, full_step(whole, state, dt));
    on_odd_partitions(mixed_mesh, [&](DistributedMesh mesh) {
      const Bed bed(std::move(mesh));
      const Column found = whole_rhs(bed, full_step(bed, state, dt));
      for (Eigen::Index i = 0; i < found.size(); ++i) EXPECT_EQ(found[i], expected[i]) << "at row " << i;
    });
  }
}

TEST_F(VelocitySolve, MatrixDoesNotDependOnThePartition) {
  const Dense expected = gather(whole_.cloth.mesh, full_step(whole_, state_, dt).matrix());
  on_odd_partitions(mixed_mesh, [&](DistributedMesh mesh) {
    const Bed bed(std::move(mesh));
    const StepSystem system = full_step(bed, state_, dt);
    EXPECT_LT(relative_error(gather(bed.cloth.mesh, system.matrix()), expected), 1e-14);
    std::vector<Mat3> blocks(bed.cloth.mesh.vertices.owned);
    system.matrix().diagonal_blocks(blocks);
    for (Local i = 0; i < bed.cloth.mesh.vertices.owned; ++i) {
      const Eigen::Index row = 3 * bed.cloth.mesh.vertices.original[i];
      EXPECT_LT(relative_error(blocks[i], expected.block<3, 3>(row, row)), 1e-12);
    }
  });
}

// The first four apply the matrix as it is, all others assemble it: so the two forms are compared as well.
TEST_F(VelocitySolve, EverySolverFindsTheSolution) {
  const std::vector<Solver> solvers{{cg, {}},
                                    {cg, {{pc, "pbjacobi"}}},
                                    {cg, {{pc, "jacobi"}}},
                                    {cg, {{pc, "none"}}},
                                    {cg, {{pc, "bjacobi"}}},
                                    {cg, {{pc, "bjacobi"}, {format, "baij"}}},
                                    {mumps, {}},
                                    {mumps, {{format, "sbaij"}}}};
  for (const Solver& solver : solvers) {
    const OptionsInForce options(solver.options);
    solve({solver.kind, 1000}, [&](const SolveReport& report, const Column& found) {
      EXPECT_EQ(report.failure, "");
      EXPECT_GT(report.iterations, 0);
      EXPECT_LT(relative_error(found, expected_), accuracy);
    });
  }
}

TEST_F(VelocitySolve, PrescribedVelocitiesStayToTheLastBit) {
  for (const auto kind : {cg, mumps})
    solve({kind, 1000}, [&](const SolveReport&, const Column& found) {
      for (Eigen::Index i = 0; i < found.size(); ++i) {
        if (!prescribed(i / 3)) continue;
        EXPECT_EQ(found[i], state_.velocities[i / 3][i % 3]);
      }
    });
}

TEST_F(VelocitySolve, ReportsThatItRanOutOfIterations) {
  solve({cg, 2}, [](const SolveReport& report, const Column&) { EXPECT_NE(report.failure, ""); });
}

TEST_F(VelocitySolve, LeavesASolutionAlone) {
  on_odd_partitions(mixed_mesh, [&](DistributedMesh mesh) {
    const Bed bed(std::move(mesh));
    const StepSystem system = full_step(bed, state_, dt);
    const std::vector<Vec3> zero(bed.cloth.mesh.vertices.size(), Vec3::Zero());
    for (const auto kind : {cg, mumps}) {
      std::vector<Vec3> v = zero;
      VelocitySystem solver(bed.cloth.mesh, bed.pattern, {kind, 1000});
      const std::vector<char> held(zero.size(), 0);
      EXPECT_EQ(solver.solve(system.matrix(), zero, held, tolerance, v).failure, "");
      EXPECT_EQ(v, zero);
    }
  });
}

// A solver is made once and used for every step: it must notice that the matrix changed, and its
// preconditioner with it.
TEST_F(VelocitySolve, FollowsAMatrixThatChanges) {
  on_odd_partitions(mixed_mesh, [&](DistributedMesh mesh) {
    const Bed bed(std::move(mesh));
    const std::vector<char> held(bed.cloth.mesh.vertices.size(), 0);
    for (const auto kind : {cg, mumps}) {
      VelocitySystem used(bed.cloth.mesh, bed.pattern, {kind, 1000});
      for (const double step : {dt, 10 * dt}) {
        const Dense a = gather(whole_.cloth.mesh, full_step(whole_, state_, step).matrix());
        const StepSystem system = full_step(bed, state_, step);
        std::vector<Vec3> v(held.size(), Vec3::Zero()), w = v;
        const SolveReport report = used.solve(system.matrix(), system.rhs(), held, tolerance, v);
        EXPECT_EQ(report.failure, "");
        const Column b = whole_rhs(bed, system), found = gather<Vec3>(world, bed.cloth.mesh.vertices, v);
        EXPECT_LT(relative_error(a * found, b), accuracy);
        VelocitySystem fresh(bed.cloth.mesh, bed.pattern, {kind, 1000});
        EXPECT_EQ(report.iterations,
                  fresh.solve(system.matrix(), system.rhs(), held, tolerance, w).iterations);
      }
    }
  });
}
