// The penalty of single triangles in Newton's method: its force and the derivative of that.
#include "src/newton/triangle_penalty.hpp"
#include "tests/support.hpp"

#include <gtest/gtest.h>

using namespace taut;
using namespace taut::test;

namespace {

constexpr double dt = 0.01; // s

/// Where triangles strain by about `stretch`, one more than the other.
std::vector<Vec3> stretched(const Cloth& cloth, double stretch) {
  const IndexMap& vertices = cloth.mesh.vertices;
  std::vector<Vec3> x = local(vertices, random_vectors(vertices.total, 0.01, 1));
  for (std::size_t i = 0; i < x.size(); ++i) x[i] += (1 + stretch) * cloth.mesh.rest_positions[i];
  return x;
}

TrianglePenalty penalty_of(const Cloth& cloth) {
  TrianglePenalty penalty(cloth, config::Inextensibility{});
  penalty.begin(std::vector<double>(cloth.mesh.vertices.size(), 2.0));
  return penalty;
}

std::vector<Vec3> residual_of(const TrianglePenalty& penalty, std::span<const Vec3> x,
                              std::span<const Vec3> v) {
  std::vector<Vec3> residual(x.size(), Vec3::Zero());
  penalty.evaluate(x, v, dt, residual);
  return residual;
}

} // namespace

TEST(TrianglePenalty, DerivativeOfWhatPullsIsThatOfItsForce) {
  on_odd_partitions(quads_and_triangles, [](DistributedMesh mesh) {
    const Cloth cloth = make_cloth(std::move(mesh), config::Material{});
    const IndexMap& vertices = cloth.mesh.vertices;
    TrianglePenalty penalty = penalty_of(cloth);
    const std::vector<Vec3> x = stretched(cloth, 0.2);
    const std::vector<Vec3> u = local(vertices, random_vectors(vertices.total, 1, 2));
    const std::vector<Vec3> at_rest(x.size(), Vec3::Zero());
    const auto at = [&](double along) {
      std::vector<Vec3> moved = x;
      for (std::size_t i = 0; i < x.size(); ++i) moved[i] += along * u[i];
      return residual_of(penalty, moved, at_rest);
    };
    constexpr double epsilon = 1e-6;
    const auto ahead = at(epsilon), behind = at(-epsilon), here = at(0);
    penalty.terms(x);
    std::vector<Vec3> v = u;
    for (Vec3& of_vertex : v) of_vertex /= dt;
    const auto held = residual_of(penalty, x, v); // and what the terms hold back of a move by u
    double largest = 0;
    for (Local i = 0; i < vertices.owned; ++i) {
      const Vec3 change = (behind[i] - ahead[i]) / (2 * epsilon);
      EXPECT_NEAR((held[i] - here[i] - change).norm(), 0, 1e-5) << i;
      largest = std::max(largest, change.norm());
    }
    EXPECT_GT(max_over(world, largest), 1);
  });
}

TEST(TrianglePenalty, PullsBackWhatIsStretchedAndPushesWhatIsPressed) {
  on_odd_partitions(quads_and_triangles, [](DistributedMesh mesh) {
    const Cloth cloth = make_cloth(std::move(mesh), config::Material{});
    const TrianglePenalty penalty = penalty_of(cloth);
    const auto power_of_growth = [&](double stretch) {
      std::vector<Vec3> x = cloth.mesh.rest_positions;
      for (Vec3& p : x) p *= 1 + stretch;
      const auto residual = residual_of(penalty, x, std::vector<Vec3>(x.size(), Vec3::Zero()));
      double sum = 0;
      for (Local i = 0; i < cloth.mesh.vertices.owned; ++i)
        sum += residual[i].dot(cloth.mesh.rest_positions[i]);
      return sum_over(world, sum);
    };
    EXPECT_LT(power_of_growth(0.04), 0);
    EXPECT_GT(power_of_growth(-0.04), 0);
    EXPECT_EQ(power_of_growth(0.02), 0); // within half of the bound
    EXPECT_EQ(power_of_growth(-0.02), 0);
  });
}
