#include "src/linear/modified_cg.hpp"
#include "src/linear/session.hpp"
#include "src/linear/velocity_system.hpp"
#include "tests/force_bed.hpp"
#include "tests/petsc_options.hpp"

#include <numeric>

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
      Freedom freedom(map.size());
      for (Local i = 0; i < map.size(); ++i)
        if (prescribed(map.original[i])) freedom.hold(i);
      std::vector<Vec3> v = local(map, state_.velocities);
      VelocitySystem solver(bed.cloth.mesh, bed.pattern, options);
      const SolveReport report = solver.solve(system.matrix(), system.rhs(), freedom, tolerance, v);
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

// The first five apply the matrix as it is, all others assemble it: so the two forms are compared as well.
TEST_F(VelocitySolve, EverySolverFindsTheSolution) {
  const std::vector<Solver> solvers{{cg, {}},
                                    {cg, {{pc, "grids"}}},
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
      const Freedom freedom(zero.size());
      EXPECT_EQ(solver.solve(system.matrix(), zero, freedom, tolerance, v).failure, "");
      EXPECT_EQ(v, zero);
    }
  });
}

// A solver is made once and used for every step: it must notice that the matrix changed, and its
// preconditioner with it.
TEST_F(VelocitySolve, FollowsAMatrixThatChanges) {
  on_odd_partitions(mixed_mesh, [&](DistributedMesh mesh) {
    const Bed bed(std::move(mesh));
    const Freedom freedom(bed.cloth.mesh.vertices.size());
    for (const auto kind : {cg, mumps}) {
      VelocitySystem used(bed.cloth.mesh, bed.pattern, {kind, 1000});
      for (const double step : {dt, 10 * dt}) {
        const Dense a = gather(whole_.cloth.mesh, full_step(whole_, state_, step).matrix());
        const StepSystem system = full_step(bed, state_, step);
        std::vector<Vec3> v(freedom.size(), Vec3::Zero()), w = v;
        const SolveReport report = used.solve(system.matrix(), system.rhs(), freedom, tolerance, v);
        EXPECT_EQ(report.failure, "");
        const Column b = whole_rhs(bed, system), found = gather<Vec3>(world, bed.cloth.mesh.vertices, v);
        EXPECT_LT(relative_error(a * found, b), accuracy);
        VelocitySystem fresh(bed.cloth.mesh, bed.pattern, {kind, 1000});
        EXPECT_EQ(report.iterations,
                  fresh.solve(system.matrix(), system.rhs(), freedom, tolerance, w).iterations);
      }
    }
  });
}

namespace {

/// Scattered vertices held, kept on a line, or kept in a plane.
Freedom scattered_freedom(std::span<const Global> originals) {
  Freedom freedom(originals.size());
  for (std::size_t i = 0; i < originals.size(); ++i) {
    const Global v = originals[i];
    const Vec3 direction = Vec3(1 + double(v % 3), -2, double(v % 5) - 0.5).normalized();
    if (v % 7 == 3) freedom.hold(Local(i));
    if (v % 7 == 4) freedom.keep_on_line(Local(i), direction);
    if (v % 7 == 5) freedom.keep_in_plane(Local(i), direction);
  }
  return freedom;
}

class ConstrainedSolve : public VelocitySolve {
protected:
  /// v = z + S y with S (A S y + A z - b) = 0, z = (I - S) v_0, by dense elimination.
  ConstrainedSolve() {
    std::vector<Global> all(whole_.cloth.mesh.vertices.total);
    std::iota(all.begin(), all.end(), 0);
    const Freedom freedom = scattered_freedom(all);
    const StepSystem system = full_step(whole_, state_, dt);
    const Dense a = gather(whole_.cloth.mesh, system.matrix());
    const Column b = whole_rhs(whole_, system);
    Dense s = Dense::Zero(a.rows(), a.cols());
    Column z(a.rows());
    for (Global v = 0; v < Global(all.size()); ++v) {
      s.block<3, 3>(3 * v, 3 * v) = freedom.projector(Local(v));
      z.segment<3>(3 * v) = freedom.denied(Local(v), state_.velocities[v]);
    }
    const Dense rest = Dense::Identity(a.rows(), a.cols()) - s;
    expected_ = z + Column((s * a * s + rest).ldlt().solve(s * (b - a * z)));
    impulse_ = rest * (a * expected_ - b);
    denied_ = rest;
  }

  Column impulse_;
  Dense denied_;
};

} // namespace

TEST_F(ConstrainedSolve, ProjectedAndModifiedCgFindTheSameSolution) {
  constexpr auto filtered = SolverOptions::Constraints::filtered;
  const std::vector<Solver> solvers{{cg, {}},
                                    {cg, {{pc, "grids"}}},
                                    {cg, {{pc, "pbjacobi"}}},
                                    {cg, {{pc, "jacobi"}}},
                                    {cg, {{pc, "bjacobi"}}},
                                    {mumps, {}}};
  std::vector<SolverOptions> options(solvers.size(), {cg, 1000});
  options.back().kind = mumps;
  options.push_back({.kind = cg, .constraints = filtered});
  for (std::size_t k = 0; k < options.size(); ++k) {
    const OptionsInForce in_force(k < solvers.size() ? solvers[k].options : std::vector<PetscSetting>());
    on_odd_partitions(mixed_mesh, [&](DistributedMesh mesh) {
      const Bed bed(std::move(mesh));
      const IndexMap& map = bed.cloth.mesh.vertices;
      const StepSystem system = full_step(bed, state_, dt);
      const Freedom freedom = scattered_freedom(map.original);
      std::vector<Vec3> v = local(map, state_.velocities);
      VelocitySystem solver(bed.cloth.mesh, bed.pattern, options[k]);
      EXPECT_EQ(solver.solve(system.matrix(), system.rhs(), freedom, tolerance, v).failure, "");
      const Column found = gather<Vec3>(world, map, v);
      EXPECT_LT(relative_error(found, expected_), accuracy);
      Column start(found.size());
      for (std::size_t i = 0; i < state_.velocities.size(); ++i)
        start.segment<3>(3 * Global(i)) = state_.velocities[i];
      EXPECT_LT((denied_ * (found - start)).norm(), 1e-13 * start.norm()); // what is denied stays
      std::vector<Vec3> impulse;
      constraint_impulse(system.matrix(), system.rhs(), freedom, v, impulse);
      EXPECT_LT(relative_error(gather<Vec3>(world, map, impulse), impulse_), accuracy);
    });
  }
}

TEST_F(ConstrainedSolve, ModifiedCgReportsThatItRanOutOfIterations) {
  on_odd_partitions(mixed_mesh, [&](DistributedMesh mesh) {
    const Bed bed(std::move(mesh));
    const StepSystem system = full_step(bed, state_, dt);
    std::vector<Vec3> v = local(bed.cloth.mesh.vertices, state_.velocities);
    const Freedom freedom(v.size());
    EXPECT_NE(modified_cg(bed.cloth.mesh, system.matrix(), system.rhs(), freedom, tolerance, 2, v).failure,
              "");
  });
}

// Forces linear in the positions: a step that also moves the cloth by y is a step from where y has moved it.
TEST(PositionAlteration, OfALinearForceIsAStepFromThere) {
  const Bed whole(serial(mixed_mesh));
  WholeState state = random_state(whole, 0), moved = state;
  const auto y = random_vectors(Global(state.positions.size()), 0.1, 77);
  for (std::size_t i = 0; i < y.size(); ++i) moved.positions[i] += y[i];
  const auto rhs_of = [&](const WholeState& s, const std::vector<Vec3>& alteration) {
    StepSystem system(whole.pattern, whole.cloth.mesh.vertices.size());
    system.start(dt);
    system.alter_positions(alteration);
    for (const MakeForce make : {bending, tension}) make(whole)->add_to(system, whole.at(s));
    return whole_rhs(whole, system);
  };
  EXPECT_LT(relative_error(rhs_of(state, local(whole.cloth.mesh.vertices, y)), rhs_of(moved, {})), 1e-12);
}

// Any force: h K y is taken off the right-hand side, with K the stiffness in the matrix.
TEST(PositionAlteration, TakesTheStiffnessTimesItOff) {
  const Bed whole(serial(mixed_mesh));
  const WholeState state = random_state(whole, 0);
  const IndexMap& map = whole.cloth.mesh.vertices;
  const auto y = local(map, random_vectors(map.total, 0.1, 77));
  for (const MakeForce make : {bending, shear, tension}) {
    const Step plain = step_of(whole, make, state, dt);
    StepSystem system(whole.pattern, map.size());
    system.start(dt);
    system.alter_positions(y);
    make(whole)->add_to(system, whole.at(state));
    const Column expected = plain.rhs - plain.matrix / dt * gather<Vec3>(self, map, y);
    EXPECT_LT(relative_error(whole_rhs(whole, system), expected), 1e-12);
  }
}

// A solver on some of the ranks asks for its options there alone.
TEST(PetscOptions, AreUnusedIfNoRankAskedForThem) {
  const OptionsInForce options({{"-asked_on_first", "1"}, {"-asked_on_last", "1"}, {"-asked_by_none", "1"}});
  const auto ask = [](const char* name) {
    PetscBool given = PETSC_FALSE;
    PetscOptionsHasName(nullptr, nullptr, name, &given);
  };
  if (rank_of(world) == 0) ask("-asked_on_first");
  if (rank_of(world) == size_of(world) - 1) ask("-asked_on_last");
  EXPECT_EQ(unused_petsc_options(world), "-asked_by_none");
}
