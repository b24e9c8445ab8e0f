// The saddle-point system of Newton's method against dense algebra, with any set, on any partition.
#include "src/constraints/edge_set.hpp"
#include "src/constraints/metric_set.hpp"
#include "src/linear/kkt_system.hpp"
#include "src/newton/newton_solver.hpp"
#include "tests/force_bed.hpp"
#include "tests/petsc_options.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>

using namespace taut;
using namespace taut::test;

namespace {

constexpr double dt = 0.02; // s

template<class Set>
MeshSlab sheet(MPI_Comm comm) {
  return make_grid(comm, {1.1, 0.8}, {12, 9},
                   std::is_same_v<Set, EdgeSet> ? GridCells::quads : GridCells::alternating_triangles);
}

/// A sheet under tension, bent and strained a little, two vertices held and one on a line.
template<class Set>
struct Stretched {
  Bed bed;
  Set set;
  State start;
  Candidate candidate;
  Freedom freedom;
  StepSystem step;
  FilteredOperator stiffness;

  explicit Stretched(DistributedMesh mesh)
      : bed(std::move(mesh)), set(bed.cloth, options(), ConstraintUse::in_newton),
        freedom(bed.cloth.mesh.vertices.size()), step(bed.pattern, bed.cloth.mesh.vertices.size()),
        stiffness(bed.cloth.mesh) {
    const IndexMap &vertices = bed.cloth.mesh.vertices, &edges = bed.cloth.mesh.edges;
    start = bed.at({random_vectors(vertices.total, 0.002, 1), random_vectors(vertices.total, 1, 2),
                    random_numbers(edges.total, 5, 3)});
    for (Local i = 0; i < vertices.size(); ++i) {
      Vec3& x = start.positions[i];
      x += bed.cloth.mesh.rest_positions[i];
      x[2] += 0.1 * std::sin(4 * x[0]);
      hold(vertices.original[i], i);
    }
    start.multipliers.stress = local(vertices, std::vector<Vec2>(vertices.total, Vec2(3, 1)));
    candidate.reset_for(start);
    candidate.multipliers.force_density = start.multipliers.force_density;
    set.start(start, dt, freedom, candidate);
    set.evaluate(start.positions);
    assemble();
  }

  static config::Inextensibility options() {
    config::Inextensibility result;
    result.compliance = 1e-4;
    return result;
  }

  void hold(Global original, Local i) {
    if (original == 0 || original == 11) freedom.hold(i);
    if (original == 5) freedom.keep_on_line(i, Vec3(1, 1, 0).normalized());
  }

  void assemble() {
    const Cloth& cloth = bed.cloth;
    step.start(dt);
    for (Local i = 0; i < cloth.mesh.vertices.owned; ++i) step.add_inertia(i, cloth.mass[i], Vec3::Zero());
    shear(bed)->add_to(step, start);
    std::vector<double> weights(cloth.mesh.edges.size());
    set.tension_weights(weights);
    const auto slots = edge_slots(cloth.mesh, bed.pattern);
    auto slot = slots.begin();
    for (Local i = 0; i < cloth.mesh.vertices.owned; ++i)
      for (const EdgeEnd& end : cloth.mesh.star_of(i)) step.stiffen(i, *slot++, weights[end.edge]);
    stiffness.set(step.matrix(), freedom);
  }

  std::vector<Vec3> right_hand_side() const {
    const IndexMap& vertices = bed.cloth.mesh.vertices;
    auto r = local(vertices, random_vectors(vertices.total, 1e-5, 7));
    r.resize(vertices.owned);
    for (Local i = 0; i < vertices.owned; ++i) r[i] = freedom.allowed(i, r[i]);
    return r;
  }
};

/// dx over all vertices, by the whole matrix; on one rank. Rows that held vertices have get the identity.
template<class Set>
Column solution(Stretched<Set>& t) {
  const Global n = 3 * t.bed.cloth.mesh.vertices.total, m = Global(t.set.rows());
  const auto a = t.set.program_compliance();
  Dense k = Dense::Zero(n + m, n + m);
  Dense s = Dense::Identity(n, n);
  for (Local i = 0; i < n / 3; ++i)
    s.block<3, 3>(3 * t.bed.cloth.mesh.vertices.original[i], 3 * t.bed.cloth.mesh.vertices.original[i]) =
        t.freedom.projector(i);
  k.topLeftCorner(n, n) = s * gather(t.bed.cloth.mesh, t.step.matrix()) * s + Dense::Identity(n, n) - s;
  std::vector<Vec3> field(t.bed.cloth.mesh.vertices.size());
  std::vector<double> z(t.set.rows()), c(t.set.rows());
  for (Global row = 0; row < m; ++row) {
    std::fill(z.begin(), z.end(), 0.0);
    std::fill(field.begin(), field.end(), Vec3::Zero());
    z[row] = -1;
    t.set.begin_spread(z);
    t.set.end_spread(field);
    k.block(0, n + row, n, 1) = s * gather<Vec3>(self, t.bed.cloth.mesh.vertices, field);
    k(n + row, n + row) = -a[row];
  }
  k.bottomLeftCorner(m, n) = k.topRightCorner(n, m).transpose();
  t.set.residual(c);
  Column b(n + m);
  b.head(n) = gather<Vec3>(self, t.bed.cloth.mesh.vertices, t.right_hand_side());
  for (Global row = 0; row < m; ++row) b[n + row] = -c[row];
  return k.fullPivLu().solve(b).head(n);
}

constexpr auto cg = SolverOptions::Kind::cg, mumps = SolverOptions::Kind::mumps;

template<class Set>
class NewtonSolvers : public testing::Test {};
using Sets = testing::Types<EdgeSet, MetricSet>;
TYPED_TEST_SUITE(NewtonSolvers, Sets);

} // namespace

TYPED_TEST(NewtonSolvers, SolveTheWholeSystemOnAnyPartition) {
  Stretched<TypeParam> whole(serial(sheet<TypeParam>));
  const Column expected = solution(whole);
  on_odd_partitions(sheet<TypeParam>, [&](DistributedMesh mesh) {
    Stretched<TypeParam> t(std::move(mesh));
    std::vector<double> c(t.set.rows()), dmu(t.set.rows());
    std::vector<Vec3> dx(t.bed.cloth.mesh.vertices.size());
    t.set.residual(c);
    const std::vector<Vec3> moved(t.bed.cloth.mesh.vertices.owned, Vec3::Zero());
    for (const auto& [kind, most, error] : {std::tuple{cg, 40, 1e-3}, std::tuple{mumps, 2, 1e-6}}) {
      NewtonSolver<TypeParam> solver(t.bed.cloth, t.bed.pattern, t.set, kind);
      solver.factor(t.stiffness);
      const auto report = solver.solve(t.right_hand_side(), c, {1e-6, 1e-6, moved, 1e-2}, 100, dx, dmu);
      EXPECT_EQ(report.failure, "");
      const auto found = gather<Vec3>(world, t.bed.cloth.mesh.vertices, dx);
      EXPECT_LT(relative_error(found, expected), error);
      EXPECT_LE(report.iterations, most);
    }
  });
}

// MUMPS may run out of memory, and its place may be taken by what does not solve.
TYPED_TEST(NewtonSolvers, TellWhyTheFactorFailed) {
  const OptionsInForce options(
      {{"-kkt_ksp_type", "gmres"}, {"-kkt_pc_type", "none"}, {"-kkt_ksp_max_it", "1"}});
  Stretched<TypeParam> t(serial(sheet<TypeParam>));
  std::vector<double> c(t.set.rows(), 1.0), dmu(t.set.rows());
  std::vector<Vec3> dx(t.bed.cloth.mesh.vertices.size());
  const std::vector<Vec3> moved(t.bed.cloth.mesh.vertices.owned, Vec3::Zero());
  NewtonSolver<TypeParam> solver(t.bed.cloth, t.bed.pattern, t.set, mumps);
  solver.factor(t.stiffness);
  EXPECT_THAT(solver.solve(t.right_hand_side(), c, {1e-6, 1e-6, moved, 1e-2}, 100, dx, dmu).failure,
              testing::HasSubstr("DIVERGED_ITS"));
}

// How far forces would move the cloth is told without solving for it, to a factor.
TYPED_TEST(NewtonSolvers, TellHowFarForcesMoveTheCloth) {
  on_odd_partitions(sheet<TypeParam>, [&](DistributedMesh mesh) {
    Stretched<TypeParam> t(std::move(mesh));
    NewtonSolver<TypeParam> solver(t.bed.cloth, t.bed.pattern, t.set, cg);
    solver.factor(t.stiffness);
    std::vector<Vec3> x(t.bed.cloth.mesh.vertices.owned), r(x);
    for (Local i = 0; i < t.bed.cloth.mesh.vertices.owned; ++i)
      x[i] = t.freedom.allowed(i, Vec3(0, 0.1, 1) * t.bed.cloth.mesh.rest_positions[i][0]);
    t.stiffness.apply(x, r);
    const double moved = solver.rms(x), told = solver.movement(r);
    EXPECT_GT(told, 0.5 * moved);
    EXPECT_LT(told, 1.5 * moved);
    for (Vec3& f : r) f *= 2;
    EXPECT_NEAR(solver.movement(r), 2 * told, 1e-9 * told);
  });
}
