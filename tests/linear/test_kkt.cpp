#include "src/linear/kkt_system.hpp"
#include "src/linear/projection_system.hpp"
#include "tests/support.hpp"

#include <gtest/gtest.h>

using namespace taut;
using namespace taut::test;

namespace {

constexpr auto cg = SolverOptions::Kind::cg, mumps = SolverOptions::Kind::mumps;

/// Everything by original number.
struct Whole {
  std::vector<double> mass, weight, scaled_compliance, gap;
  std::vector<Vec3> gradient, force;
  std::vector<char> prescribed;

  /// With scattered vertices held, of which some are the two ends of an edge.
  explicit Whole(const DistributedMesh& mesh)
      : mass(random_numbers(mesh.vertices.total, 0.5, 1)), weight(random_numbers(mesh.edges.total, 0.5, 2)),
        scaled_compliance(random_numbers(mesh.edges.total, 0.1, 3)),
        gap(random_numbers(mesh.edges.total, 1, 4)), gradient(random_vectors(mesh.edges.total, 1, 5)),
        force(random_vectors(mesh.vertices.total, 1, 6)), prescribed(mesh.vertices.total, 0) {
    for (double& m : mass) m += 1;
    for (double& w : weight) w += 0.5;
    for (double& a : scaled_compliance) a += 0.2;
    for (const Global held : {0, 1, 8, 13, 18, 22}) prescribed[held] = 1;
    for (Local e = 0; e < mesh.edges.owned; ++e) {
      const auto& [a, b] = mesh.edge_vertices[e];
      if (prescribed[mesh.vertices.original[a]] && prescribed[mesh.vertices.original[b]])
        gap[mesh.edges.original[e]] = 0;
    }
  }
};

/// dx, then dmu, by the definition of the matrix.
Column solution(const DistributedMesh& mesh, const Whole& w) {
  const Global n = 3 * mesh.vertices.total, m = mesh.edges.total;
  Dense k = Dense::Zero(n + m, n + m);
  Column b = Column::Zero(n + m);
  for (Global v = 0; v < mesh.vertices.total; ++v) {
    k.block<3, 3>(3 * v, 3 * v) = w.mass[v] * Mat3::Identity();
    b.segment<3>(3 * v) = w.force[v];
  }
  for (Local e = 0; e < mesh.edges.owned; ++e) {
    const Global row = mesh.edges.original[e], a = mesh.vertices.original[mesh.edge_vertices[e][0]],
                 c = mesh.vertices.original[mesh.edge_vertices[e][1]];
    for (const auto& [i, j, sign] : {std::tuple{a, a, 1.0}, {c, c, 1.0}, {a, c, -1.0}, {c, a, -1.0}})
      k.block<3, 3>(3 * i, 3 * j) += sign * w.weight[row] * Mat3::Identity();
    k.block<1, 3>(n + row, 3 * a) = -w.gradient[row].transpose();
    k.block<1, 3>(n + row, 3 * c) = w.gradient[row].transpose();
    k(n + row, n + row) = w.prescribed[a] && w.prescribed[c] ? -1 : -w.scaled_compliance[row];
    b[n + row] = -w.gap[row];
  }
  k.topRightCorner(n, m) = k.bottomLeftCorner(m, n).transpose();
  for (Global v = 0; v < mesh.vertices.total; ++v)
    if (w.prescribed[v]) {
      k.middleRows(3 * v, 3).setZero();
      k.middleCols(3 * v, 3).setZero();
      k.block<3, 3>(3 * v, 3 * v).setIdentity();
      b.segment<3>(3 * v).setZero();
    }
  return k.partialPivLu().solve(b);
}

} // namespace

TEST(KktSystem, SolvesForPositionsAndTensions) {
  const DistributedMesh whole_mesh = serial(mixed_mesh);
  const Whole whole(whole_mesh);
  const Column expected = solution(whole_mesh, whole);
  for (const auto kind : {cg, mumps})
    on_odd_partitions(mixed_mesh, [&](DistributedMesh mesh) {
      const Pattern pattern(mesh);
      KktSystem system(mesh, pattern, {.kind = kind});
      const auto mass = local(mesh.vertices, whole.mass), weight = local(mesh.edges, whole.weight),
                 scaled_compliance = local(mesh.edges, whole.scaled_compliance),
                 gap = local(mesh.edges, whole.gap);
      const auto gradient = local(mesh.edges, whole.gradient), force = local(mesh.vertices, whole.force);
      const auto prescribed = local(mesh.vertices, whole.prescribed);
      const Freedom freedom(prescribed);
      system.assemble({mass, weight, gradient, scaled_compliance, &freedom});
      std::vector<Vec3> dx(mesh.vertices.size());
      std::vector<double> dmu(mesh.edges.size());
      EXPECT_EQ(system.solve(force, gap, 1e-12, dx, dmu).failure, "");
      Column found(expected.size());
      found << gather<Vec3>(mesh.comm, mesh.vertices, dx), gather<double>(mesh.comm, mesh.edges, dmu);
      EXPECT_LT(relative_error(found, expected), 1e-9);
      for (Local i = 0; i < mesh.vertices.size(); ++i) // ghosts too
        EXPECT_EQ(dx[i], Vec3(found.segment<3>(3 * mesh.vertices.original[i])));
      for (Local e = 0; e < mesh.edges.size(); ++e)
        EXPECT_EQ(dmu[e], found[3 * mesh.vertices.total + mesh.edges.original[e]]);
    });
}

// (J' W J^T + a) mu = b with other gradients in J' than in J.
TEST(NonsymmetricProjection, SolvesItsSystem) {
  const DistributedMesh whole_mesh = serial(mixed_mesh);
  const Whole whole(whole_mesh);
  const Global n = 3 * whole_mesh.vertices.total, m = whole_mesh.edges.total;
  std::vector<Vec3> rows = random_vectors(m, 0.3, 7);
  for (Global e = 0; e < m; ++e) rows[e] += whole.gradient[e];
  Dense j = Dense::Zero(m, n), turned = j, w = Dense::Zero(n, n);
  std::vector<double> inverse_mass(whole_mesh.vertices.total), scaled_compliance = whole.scaled_compliance;
  for (Global v = 0; v < whole_mesh.vertices.total; ++v) {
    inverse_mass[v] = whole.prescribed[v] ? 0 : 1 / whole.mass[v];
    w.block<3, 3>(3 * v, 3 * v) = inverse_mass[v] * Mat3::Identity();
  }
  for (Local e = 0; e < whole_mesh.edges.owned; ++e) {
    const Global row = whole_mesh.edges.original[e];
    for (const auto& [end, sign] : {std::pair{0, -1.0}, {1, 1.0}}) {
      const Global v = whole_mesh.vertices.original[whole_mesh.edge_vertices[e][end]];
      j.block<1, 3>(row, 3 * v) = sign * whole.gradient[row].transpose();
      turned.block<1, 3>(row, 3 * v) = sign * rows[row].transpose();
    }
  }
  Dense matrix = turned * w * j.transpose();
  for (Global e = 0; e < m; ++e)
    matrix(e, e) += j.row(e) * w * j.row(e).transpose() > 0 ? scaled_compliance[e] : 1;
  const Column expected =
      matrix.partialPivLu().solve(Eigen::Map<const Column>(whole.gap.data(), Eigen::Index(whole.gap.size())));
  for (const auto kind : {cg, mumps})
    on_odd_partitions(mixed_mesh, [&](const DistributedMesh& mesh) {
      ProjectionSystem system(mesh, {.kind = kind, .matrix = SolverOptions::Matrix::nonsymmetric});
      system.assemble(local(mesh.edges, rows), local(mesh.edges, whole.gradient),
                      local(mesh.vertices, inverse_mass), Freedom(mesh.vertices.size()),
                      local(mesh.edges, scaled_compliance));
      std::vector<double> mu(mesh.edges.size());
      EXPECT_EQ(system.solve(local(mesh.edges, whole.gap), 1e-12, mu).failure, "");
      EXPECT_LT(relative_error(gather<double>(mesh.comm, mesh.edges, mu), expected), 1e-9);
    });
}
