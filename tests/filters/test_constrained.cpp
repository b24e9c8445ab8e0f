// SHAKE, RATTLE, ICD and SAP.
#include "tests/throw.hpp"

using namespace taut;
using namespace taut::test;
using enum config::InextensibilityMethod;

namespace {

constexpr auto cg = config::LinearSolver::cg, mumps = config::LinearSolver::mumps;

MeshSlab sheet(MPI_Comm comm) { return make_grid(comm, {0.8, 0.6}, {9, 7}); }

Vec3 rest_of(Global v) { return {0.1 * double(v % 9), 0.1 * double(v / 9), 0}; }

/// Two opposite corners held, the others moved by up to 1 cm an axis and downwards.
std::optional<Vec3> disturbed(Global v) {
  static const auto noise = random_vectors(63, 0.01, 8);
  if (v == 0 || v == 62) return std::nullopt;
  return Vec3(rest_of(v) + noise[v] - Vec3(0, 0, 0.02));
}

/// The step by a method, on all partitions; calls `check` after it.
void throw_sheet(const config::Inextensibility& how,
                 const std::function<void(const Thrown&, const FilterReport&)>& check) {
  on_odd_partitions(sheet, [&](DistributedMesh mesh) {
    Thrown t(std::move(mesh), rest_of, disturbed);
    const FilterReport report = t.apply(how);
    check(t, report);
  });
}

/// Where one rank alone brings the sheet.
Column alone(const config::Inextensibility& how) {
  Thrown t(serial(sheet), rest_of, disturbed);
  EXPECT_EQ(t.apply(how).failure, "");
  return t.end();
}

double largest_distance(const Column& a, const Column& b) { return (a - b).cwiseAbs().maxCoeff(); }

} // namespace

TEST(Constrained, MethodsReachTheLimitAndHoldPinsAtAnyRankCount) {
  for (const auto m : {icd, sap, shake, rattle})
    for (const auto solver : {cg, mumps}) {
      const auto how = method(m, solver, 1e-6);
      const Column expected = alone(how);
      throw_sheet(how, [&](const Thrown& t, const FilterReport& report) {
        EXPECT_EQ(report.failure, "");
        EXPECT_LE(t.strain(), 1e-6);
        EXPECT_GT(report.iterations, 1);
        EXPECT_GT(report.linear_iterations, 0);
        const Column end = t.end();
        EXPECT_LT(largest_distance(end, expected), 1e-6);
        EXPECT_EQ(end.segment<3>(0), rest_of(0));
        EXPECT_EQ(end.segment<3>(3 * 62), rest_of(62));
      });
    }
}

// [G07, theorem]: both are the point of the manifold that is closest to the candidate.
TEST(Constrained, IcdIsStepAndProject) {
  for (const auto solver : {cg, mumps}) {
    const Column a = alone(method(icd, solver, 1e-13)), b = alone(method(sap, solver, 1e-13));
    EXPECT_LT(largest_distance(a, b), 1e-10);
  }
  const Column fast = alone(method(fast_projection, mumps, 1e-13)), exact = alone(method(icd, mumps, 1e-13));
  EXPECT_GT(largest_distance(fast, exact), 1e-7); // which fast projection only approximates
  EXPECT_LT(largest_distance(fast, exact), 5e-3);
}

// Nobody on the manifold, among neighbours of the result in directions that keep the lengths, is closer to
// the candidate: M (x - x0) is a combination of the gradients, M (x - x0) + J^T mu = 0.
TEST(Constrained, IcdEndsWhereForcesBalance) {
  Thrown t(serial(sheet), rest_of, disturbed);
  const Column x0 = t.end();
  ASSERT_EQ(t.apply(method(icd, mumps, 1e-12)).failure, "");
  const Column x = t.end();
  Column force = Column::Zero(x.size());
  const DistributedMesh& mesh = t.cloth.mesh;
  for (Local i = 0; i < mesh.vertices.owned; ++i) {
    const Global v = mesh.vertices.original[i];
    force.segment<3>(3 * v) += t.cloth.mass[i] * (x - x0).segment<3>(3 * v);
  }
  const double scale = force.cwiseAbs().maxCoeff();
  for (Local e = 0; e < mesh.edges.owned; ++e) {
    const Global a = mesh.vertices.original[mesh.edge_vertices[e][0]],
                 b = mesh.vertices.original[mesh.edge_vertices[e][1]];
    const Vec3 pull =
        t.candidate.multipliers.force_density[e] * t.dt * t.dt * (x.segment<3>(3 * b) - x.segment<3>(3 * a));
    force.segment<3>(3 * a) -= pull;
    force.segment<3>(3 * b) += pull;
  }
  for (const Global pin : {0, 62}) force.segment<3>(3 * pin).setZero();
  EXPECT_LT(force.cwiseAbs().maxCoeff(), 1e-9 * scale);
}

TEST(Constrained, FirstIterationsOfIcdAndFastProjectionAgree) {
  auto one_icd = method(icd, mumps, 1e-6), one_fast = method(fast_projection, mumps, 1e-6);
  one_icd.max_iterations = one_fast.max_iterations = 1;
  Thrown a(serial(sheet), rest_of, disturbed), b(serial(sheet), rest_of, disturbed);
  const Column before = a.end();
  EXPECT_NE(a.apply(one_icd).failure, "");
  EXPECT_NE(b.apply(one_fast).failure, "");
  EXPECT_GT(largest_distance(a.end(), before), 1e-3);
  EXPECT_LT(largest_distance(a.end(), b.end()), 1e-12);
}

// Newton's method for both residuals, by their derivatives: the number of right digits doubles.
TEST(Constrained, NewtonMethodsConvergeQuadratically) {
  for (const auto m : {icd, sap, shake}) {
    std::vector<double> errors;
    const Column end = alone(method(m, mumps, 1e-13));
    for (int iterations = 2; iterations <= 4; ++iterations) {
      auto how = method(m, mumps, 1e-14);
      how.max_iterations = iterations;
      Thrown t(serial(sheet), rest_of, disturbed);
      t.apply(how);
      errors.push_back(largest_distance(t.end(), end));
    }
    const double order = std::log(errors[2] / errors[1]) / std::log(errors[1] / errors[0]);
    EXPECT_GT(order, 1.5) << words_of(m)[std::size_t(m)] << " errors " << errors[0] << " " << errors[1] << " "
                          << errors[2];
  }
}

TEST(Constrained, LaggedShakeComesToTheSamePlace) {
  auto lagged = method(shake, mumps, 1e-10);
  const Column newton = alone(lagged);
  lagged.shake = config::Shake{config::ShakeMatrix::lagged};
  EXPECT_LT(largest_distance(alone(lagged), newton), 1e-9);
}

// What mu_c the step before left is part of the result, not added to it.
TEST(Constrained, CarriedTensionDoesNotChangeTheResult) {
  constexpr double density = 0.5; // N/m
  for (const auto m : {icd, sap}) {
    const auto how = method(m, mumps, 1e-13);
    Thrown plain(serial(sheet), rest_of, disturbed), carried(serial(sheet), rest_of, disturbed);
    ASSERT_EQ(plain.apply(how).failure, "");
    const DistributedMesh& mesh = carried.cloth.mesh;
    std::fill(carried.candidate.multipliers.force_density.begin(),
              carried.candidate.multipliers.force_density.end(), density);
    Dense a = Dense::Zero(3 * 63, 3 * 63); // a candidate with tension in it: (M + h^2 L(q)) x = M x0
    Column b = Column::Zero(3 * 63);
    const Column x0 = carried.end();
    for (Local i = 0; i < mesh.vertices.owned; ++i) {
      const Global v = mesh.vertices.original[i];
      const double m_i = carried.cloth.mass[i];
      b.segment<3>(3 * v) = m_i * x0.segment<3>(3 * v);
      a.block<3, 3>(3 * v, 3 * v) += m_i * Mat3::Identity();
      if (carried.prescribed[i]) continue;
      for (const EdgeEnd& end : mesh.star_of(i)) {
        const double k = density * carried.dt * carried.dt;
        a.block<3, 3>(3 * v, 3 * v) += k * Mat3::Identity();
        a.block<3, 3>(3 * v, 3 * mesh.vertices.original[end.other]) -= k * Mat3::Identity();
      }
    }
    const Column x = a.partialPivLu().solve(b);
    for (Local i = 0; i < mesh.vertices.owned; ++i)
      carried.candidate.velocities[i] =
          (x.segment<3>(3 * mesh.vertices.original[i]) - carried.start.positions[i]) / carried.dt;
    EXPECT_GT(largest_distance(carried.end(), x0), 1e-4);
    ASSERT_EQ(carried.apply(how).failure, "");
    EXPECT_LT(largest_distance(carried.end(), plain.end()), 1e-11);
  }
}

TEST(Rattle, LeavesVelocitiesThatChangeNoLength) {
  throw_sheet(method(rattle, mumps, 1e-8), [](const Thrown& t, const FilterReport& report) {
    EXPECT_EQ(report.failure, "");
    ASSERT_EQ(t.candidate.end_velocities.size(), t.candidate.velocities.size());
    const DistributedMesh& mesh = t.cloth.mesh;
    const auto rate = [&](Local e, const std::vector<Vec3>& v) {
      const auto& [a, b] = mesh.edge_vertices[e];
      const Vec3 d = t.start.positions[b] - t.start.positions[a] +
                     t.dt * (t.candidate.velocities[b] - t.candidate.velocities[a]);
      return std::abs(d.dot(v[b] - v[a])) / d.norm();
    };
    double before = 0, after = 0;
    for (Local e = 0; e < mesh.edges.owned; ++e) {
      before = std::max(before, rate(e, t.candidate.velocities));
      after = std::max(after, rate(e, t.candidate.end_velocities));
    }
    EXPECT_GT(max_over(world, before), 1e-2);
    EXPECT_LT(max_over(world, after), 1e-10);
  });
}

TEST(Constrained, MethodsSaySoIfTheyDoNotGetThere) {
  for (const auto m : {icd, sap, shake, rattle}) {
    auto how = method(m, cg, 1e-9);
    how.max_iterations = 1;
    throw_sheet(how, [&](const Thrown&, const FilterReport& report) {
      const std::string name(words_of(m)[std::size_t(m)]);
      EXPECT_EQ(report.failure.find(name + " left a strain of "), 0u) << report.failure;
      EXPECT_EQ(report.iterations, 1);
    });
  }
}

// The ways in which SHAKE fails [G07 section 4.1]: chains of links of length 1, ends held unless said
// otherwise.
namespace {

MeshSlab chain(MPI_Comm comm, int links) { return make_line(comm, links, links + 1); }

/// Report and end positions of a step of a chain, by one rank and by all.
struct Result {
  FilterReport report;
  Column end;
};

Result throw_chain(const std::vector<Vec3>& from, const std::vector<std::optional<Vec3>>& to,
                   const config::Inextensibility& how) {
  const int links = int(from.size()) - 1;
  const auto make = [&](MPI_Comm comm) { return chain(comm, links); };
  Result result;
  on_odd_partitions(make, [&](DistributedMesh mesh) {
    Thrown t(
        std::move(mesh), [&](Global v) { return from[v]; }, [&](Global v) { return to[v]; });
    result.report = t.apply(how);
    result.end = t.end();
  });
  return result;
}

/// For what tabulates the outcomes: gtest puts them into its report.
void note(const char* method, const FilterReport& report) {
  testing::Test::RecordProperty(method, report.failure.empty() ? "converges" : report.failure);
}

void expect_shake_fails(const std::vector<Vec3>& from, const std::vector<std::optional<Vec3>>& to) {
  for (const auto matrix : {config::ShakeMatrix::newton, config::ShakeMatrix::lagged}) {
    auto how = method(shake, mumps, 1e-6);
    how.shake = config::Shake{matrix};
    const FilterReport report = throw_chain(from, to, how).report;
    note("shake", report);
    EXPECT_NE(report.failure.find("take smaller steps, or method icd"), std::string::npos) << report.failure;
  }
}

constexpr std::nullopt_t held = std::nullopt;

} // namespace

// Pulled sideways by more than its length, an edge finds no point of its length along its old direction,
// though the matrix is regular.
TEST(ShakeFailure, Q1NoSolution) {
  const std::vector<Vec3> from{{0, 0, 0}, {1, 0, 0}};
  const std::vector<std::optional<Vec3>> to{held, Vec3(0.3, 2, 0)};
  expect_shake_fails(from, to);
  for (const auto solver : {cg, mumps}) {
    const Result found = throw_chain(from, to, method(icd, solver, 1e-9));
    note("icd", found.report);
    EXPECT_EQ(found.report.failure, "");
    EXPECT_LT((found.end.segment<3>(3) - Vec3(0.3, 2, 0).normalized()).norm(), 1e-8);
  }
}

// Turned by a right angle, an edge has no slope along its old direction, though there are solutions.
TEST(ShakeFailure, Q2SingularThoughThereAreSolutions) {
  const std::vector<Vec3> from{{0, 0, 0}, {1, 0, 0}};
  const std::vector<std::optional<Vec3>> to{held, Vec3(0, 0.5, 0)};
  expect_shake_fails(from, to);
  for (const auto solver : {cg, mumps}) {
    const Result found = throw_chain(from, to, method(icd, solver, 1e-9));
    note("icd", found.report);
    EXPECT_EQ(found.report.failure, "");
    EXPECT_LT((found.end.segment<3>(3) - Vec3(0, 1, 0)).norm(), 1e-8);
  }
}

// Two links on one line between their pins: gradients that depend on each other. ICD fails too, but not in
// half the step, where the candidate has not come as far.
TEST(ShakeFailure, Q3DependentGradients) {
  const double height = std::sqrt(1 - 0.81);
  const std::vector<Vec3> from{{-0.9, 0, 0}, {0, height, 0}, {0.9, 0, 0}};
  const std::vector<std::optional<Vec3>> whole{held, Vec3(0, 0, 0), held},
      half{held, Vec3(0, height / 2, 0), held};
  expect_shake_fails(from, whole);
  EXPECT_NE(throw_chain(from, whole, method(icd, mumps, 1e-9)).report.failure, "");
  const Result found = throw_chain(from, half, method(icd, mumps, 1e-9));
  note("icd", found.report);
  EXPECT_EQ(found.report.failure, "");
  EXPECT_LT((found.end.segment<3>(3) - Vec3(0, height, 0)).norm(), 1e-8);
}

// Two links from one point to one vertex: one of them is redundant. The closest point exists; a compliance
// shares the tension between the two.
TEST(ShakeFailure, Q4RedundantConstraints) {
  const std::vector<Vec3> from{{0, 0, 0}, {1, 0, 0}, {0, 0, 0}};
  const Vec3 target(0.9, 0.6, 0);
  const std::vector<std::optional<Vec3>> to{held, target, held};
  expect_shake_fails(from, to);
  for (const auto solver : {cg, mumps}) {
    auto how = method(icd, solver, 1e-6);
    how.compliance = 1e-9;
    const Result found = throw_chain(from, to, how);
    note("icd", found.report);
    EXPECT_EQ(found.report.failure, "");
    EXPECT_LT((found.end.segment<3>(3) - target.normalized()).norm(), 1e-5);
  }
}
