#include "src/filters/fast_projection.hpp"
#include "src/linear/projection_system.hpp"
#include "tests/support.hpp"

#include <gtest/gtest.h>

using namespace taut;
using namespace taut::test;

namespace {

constexpr auto cg = SolverOptions::Kind::cg, mumps = SolverOptions::Kind::mumps;

/// J W J^T + diag a by its definition: row e of J holds g_e at the edge's second vertex and -g_e at its
/// first. An edge that cannot move gets the row of the unit matrix.
struct Truth {
  std::vector<Vec3> gradient;
  std::vector<double> inverse_mass, scaled_compliance;

  /// With scattered vertices held, of which some are the two ends of an edge.
  explicit Truth(const DistributedMesh& whole)
      : gradient(random_vectors(whole.edges.total, 1, 3)),
        inverse_mass(random_numbers(whole.vertices.total, 0.5, 4)),
        scaled_compliance(random_numbers(whole.edges.total, 0.1, 5)) {
    for (double& w : inverse_mass) w += 1; // 0.5 to 1.5
    for (double& a : scaled_compliance) a += 0.1;
    for (const Global held : {0, 1, 8, 13, 18, 22}) inverse_mass[held] = 0;
  }

  Dense matrix(const DistributedMesh& whole) const {
    Dense j = Dense::Zero(whole.edges.total, 3 * whole.vertices.total), w = Dense::Zero(j.cols(), j.cols());
    Column diagonal = Column::Zero(j.rows());
    for (Local e = 0; e < whole.edges.owned; ++e) {
      const Global row = whole.edges.original[e];
      const Global a = whole.vertices.original[whole.edge_vertices[e][0]];
      const Global b = whole.vertices.original[whole.edge_vertices[e][1]];
      j.block<1, 3>(row, 3 * a) = -gradient[row].transpose();
      j.block<1, 3>(row, 3 * b) = gradient[row].transpose();
      diagonal[row] = inverse_mass[a] + inverse_mass[b] > 0 ? scaled_compliance[row] : 1;
    }
    for (Global v = 0; v < whole.vertices.total; ++v)
      w.block<3, 3>(3 * v, 3 * v) = inverse_mass[v] * Mat3::Identity();
    return j * w * j.transpose() + Dense(diagonal.asDiagonal());
  }
};

/// The inverse as the system sees it: its solutions for all unit vectors.
Dense inverse(const DistributedMesh& mesh, const Truth& truth, SolverOptions::Kind kind) {
  const IndexMap& map = mesh.edges;
  ProjectionSystem system(mesh, {kind, 1000});
  system.assemble(local(map, truth.gradient), local(mesh.vertices, truth.inverse_mass),
                  local(map, truth.scaled_compliance));
  Dense inverse(map.total, map.total);
  for (Global column = 0; column < map.total; ++column) {
    std::vector<double> rhs, mu(map.size());
    for (Local e = 0; e < map.owned; ++e) rhs.push_back(map.original[e] == column);
    EXPECT_EQ(system.solve(rhs, 1e-13, mu).failure, "");
    inverse.col(column) = gather<double>(mesh.comm, map, mu);
    for (Local e = 0; e < map.size(); ++e) EXPECT_EQ(mu[e], inverse(map.original[e], column)); // ghosts
  }
  return inverse;
}

} // namespace

TEST(ProjectionSystem, IsJWJTransposedPlusShift) {
  const DistributedMesh whole = serial(mixed_mesh);
  const Truth truth(whole);
  const Dense expected =
      truth.matrix(whole).ldlt().solve(Dense::Identity(whole.edges.total, whole.edges.total));
  // The condition number is some hundreds: CG's 1e-13, in the natural norm, leaves at most 1e-11.
  on_odd_partitions(mixed_mesh, [&](const DistributedMesh& mesh) {
    for (const auto kind : {cg, mumps})
      EXPECT_LT(relative_error(inverse(mesh, truth, kind), expected), 1e-10);
  });
}

TEST(ProjectionSystem, FollowsValuesThatChange) {
  const DistributedMesh whole = serial(mixed_mesh);
  Truth truth(whole), other = truth;
  for (Vec3& g : other.gradient) g = Vec3(3 * g[1], g[0] - 1, 2 * g[2]);
  const Column b = Column::LinSpaced(whole.edges.total, -1, 2);
  on_odd_partitions(mixed_mesh, [&](const DistributedMesh& mesh) {
    const IndexMap& map = mesh.edges;
    const std::vector<double> rhs = local(map, std::vector<double>(b.begin(), b.end()));
    for (const auto kind : {cg, mumps}) {
      ProjectionSystem used(mesh, {kind, 1000});
      for (const Truth& t : {truth, other}) {
        ProjectionSystem fresh(mesh, {kind, 1000});
        std::vector<double> mu(map.size());
        std::vector<int> iterations;
        for (ProjectionSystem* system : {&fresh, &used}) {
          system->assemble(local(map, t.gradient), local(mesh.vertices, t.inverse_mass),
                           local(map, t.scaled_compliance));
          const SolveReport report = system->solve(rhs, 1e-13, mu);
          EXPECT_EQ(report.failure, "");
          iterations.push_back(report.iterations);
        }
        EXPECT_LT(relative_error(t.matrix(whole) * gather<double>(world, map, mu), b), 1e-10);
        EXPECT_EQ(iterations[0], iterations[1]); // the preconditioner has followed as well
      }
    }
  });
}
