#include "src/state/material_coordinates.hpp"
#include "tests/forces/differences.hpp"

using namespace taut;
using namespace taut::test;

namespace {

using Energy = OnABed;
using Stiffness = OnABed;
using StepParts = OnABed;

} // namespace

TEST_F(Energy, HasTheForceAsItsGradient) {
  for (const MakeForce make : {bending, shear, gravity}) expect_force_is_gradient(whole_, make);
}

TEST_F(Energy, IsSharedOutOverTheRanks) {
  on_odd_partitions(mixed_mesh, [&](DistributedMesh mesh) {
    const Bed bed(std::move(mesh));
    for (const MakeForce make : {bending, shear, gravity}) {
      const double expected = make(whole_)->energy(whole_.at(state_));
      EXPECT_NEAR(sum_over(world, make(bed)->energy(bed.at(state_))), expected,
                  round_off * std::abs(expected));
    }
  });
}

TEST_F(Stiffness, OfBendingIsTheHessian) {
  const Dense expected = hessian_of(whole_, bending, state_);
  on_odd_partitions(mixed_mesh, [&](DistributedMesh mesh) {
    const Bed bed(std::move(mesh));
    EXPECT_LT(relative_error(step_of(bed, bending, state_, 1.0).matrix, expected), difference_tolerance);
  });
}

namespace {

/// A scalar stencil times the unit matrix, added to a whole matrix.
void add_outer(const std::array<Global, 4>& vertices, const std::array<double, 4>& w, double scale,
               Dense& all) {
  for (int a = 0; a < 4; ++a)
    for (int b = 0; b < 4; ++b)
      all.block<3, 3>(3 * vertices[a], 3 * vertices[b]) += scale * w[a] * w[b] * Mat3::Identity();
}

/// The negative half of the Hessian of shear, which is left out: for C > 0 that of n = c_u - c_v, for C < 0
/// that of n = c_u + c_v, with the factor G A |C| / 2.
Dense negative_half(const Bed& whole, const WholeState& state) {
  const DistributedMesh& mesh = whole.cloth.mesh;
  Dense all = Dense::Zero(3 * mesh.vertices.total, 3 * mesh.vertices.total);
  for (std::size_t i = 0; i < mesh.cells.size(); ++i) {
    const LocalCell& cell = mesh.cells[i];
    if (cell.size() == 2) continue;
    const bool quad = cell.size() == 4;
    std::array<Vec3, 4> rest, x;
    std::array<Global, 4> original;
    for (int k = 0; k < 4; ++k) {
      const Local v = cell.vertices[k < cell.size() ? k : 0];
      original[k] = mesh.vertices.original[v];
      rest[k] = mesh.rest_positions[v];
      x[k] = state.positions[original[k]];
    }
    const double area = 0.5 * (rest[2] - rest[0]).cross(rest[quad ? 3 : 2] - rest[1]).norm();
    const ShearStencil s =
        quad ? quad_shear_stencil(rest) : triangle_shear_stencil(material_coordinates(mesh, i));
    const double c = evaluate(s, x).condition;
    std::array<double, 4> n;
    for (int k = 0; k < 4; ++k) n[k] = c > 0 ? s.c_u[k] - s.c_v[k] : s.c_u[k] + s.c_v[k];
    add_outer(original, n, material.shear * area * std::abs(c) / 2, all);
  }
  return all;
}

} // namespace

TEST_F(Stiffness, OfShearIsTheHessianWithoutItsNegativeHalf) {
  for (unsigned seed = 0; seed < states; ++seed) {
    const WholeState state = random_state(whole_, seed);
    const Dense hessian = hessian_of(whole_, shear, state), expected = hessian + negative_half(whole_, state);
    EXPECT_GT(relative_error(hessian, expected), 0.01); // there is something to leave out
    on_odd_partitions(mixed_mesh, [&](DistributedMesh mesh) {
      const Bed bed(std::move(mesh));
      EXPECT_LT(relative_error(step_of(bed, shear, state, 1.0).matrix, expected), difference_tolerance);
    });
  }
}

TEST_F(Stiffness, IsSymmetricAndPositiveSemiDefinite) {
  for (const MakeForce make : {bending, shear, damped_shear, drag, tension})
    expect_semi_definite(whole_, make);
}

// A step adds h f on the right and h D + h^2 K on the left.
TEST_F(StepParts, ScaleWithTheStep) {
  constexpr double h = 0.013;
  for (const MakeForce make : {bending, shear, tension, drag}) {
    const Step one = step_of(whole_, make, state_, 1.0), small = step_of(whole_, make, state_, h);
    EXPECT_LT(relative_error(small.rhs, h * one.rhs), round_off);
    EXPECT_LT(relative_error(small.matrix, (make == drag ? h : h * h) * one.matrix), round_off);
  }
}

TEST_F(StepParts, AddUpWithInertia) {
  constexpr double h = 0.013;
  const Cloth& cloth = whole_.cloth;
  Dense matrix = Dense::Zero(3 * cloth.mesh.vertices.total, 3 * cloth.mesh.vertices.total);
  Column rhs = Column::Zero(matrix.rows());
  for (Local i = 0; i < cloth.mesh.vertices.owned; ++i) {
    const Global v = cloth.mesh.vertices.original[i];
    matrix.block<3, 3>(3 * v, 3 * v) = cloth.mass[i] * Mat3::Identity();
    rhs.segment<3>(3 * v) = cloth.mass[i] * state_.velocities[v];
  }
  for (const MakeForce make : {gravity, damped_bending, damped_shear, drag, tension}) {
    const Step part = step_of(whole_, make, state_, h);
    matrix += part.matrix;
    rhs += part.rhs;
  }
  on_odd_partitions(mixed_mesh, [&](DistributedMesh mesh) {
    const Bed bed(std::move(mesh));
    const StepSystem system = full_step(bed, state_, h);
    EXPECT_LT(relative_error(gather(bed.cloth.mesh, system.matrix()), matrix), round_off);
    EXPECT_LT(relative_error(whole_rhs(bed, system), rhs), round_off);
  });
}

TEST_F(StepParts, DampingOfBendingIsProportionalToItsStiffness) {
  constexpr double h = 0.013;
  const Dense k = step_of(whole_, bending, state_, 1.0).matrix;
  EXPECT_LT(relative_error(step_of(whole_, damped_bending, state_, h).matrix, (h * h + h * beta) * k),
            round_off);
}

// Of cloth that does not move, D is beta G A dC dC^T, which has no other term, while K has one that vanishes
// where C does: in the rest shape.
TEST_F(StepParts, DampingOfShearIsThatOfItsCondition) {
  constexpr double h = 0.013;
  const auto damping = [&](const WholeState& s) {
    return Dense(step_of(whole_, damped_shear, s, h).matrix - step_of(whole_, shear, s, h).matrix);
  };
  WholeState still = state_;
  for (Vec3& v : still.velocities) v.setZero();
  WholeState doubled = still, rest = still;
  for (Vec3& x : doubled.positions) x *= 2; // and so dC
  EXPECT_LT(relative_error(damping(doubled), 4 * damping(still)),
            100 * round_off); // differences of like numbers

  const DistributedMesh& mesh = whole_.cloth.mesh;
  for (Local i = 0; i < mesh.vertices.owned; ++i)
    rest.positions[mesh.vertices.original[i]] = mesh.rest_positions[i];
  const Dense k = step_of(whole_, shear, rest, 1.0).matrix;
  EXPECT_LT(relative_error(damping(rest), h * beta * k), 100 * round_off);
}

TEST(ShearStencil, ConditionIsTheCosineBetweenTheYarns) {
  // A rectangle sheared by an angle a without stretch: w_u . w_v = sin a, 0 at rest.
  const double a = 0.3, lu = 0.2, lv = 0.5;
  const Vec3 u(lu, 0, 0), v(lv * std::sin(a), lv * std::cos(a), 0), flat(0, lv, 0), origin(1, 2, 3);
  const ShearStencil s = quad_shear_stencil({origin, origin + u, origin + u + flat, origin + flat});
  EXPECT_NEAR(s.rest, 0, round_off);
  EXPECT_NEAR(evaluate(s, {origin, origin + u, origin + u + v, origin + v}).condition, std::sin(a),
              round_off);
}

TEST(ShearStencil, GradientIsTheDerivativeOfTheCondition) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const auto noise = random_vectors(8, 0.2, seed);
    const std::array<Vec3, 4> square{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(0, 1, 0)};
    std::array<Vec3, 4> rest, x;
    for (int k = 0; k < 4; ++k) rest[k] = square[k] + noise[k], x[k] = square[k] + noise[4 + k];
    const ShearStencil s = quad_shear_stencil(rest);
    EXPECT_NEAR(evaluate(s, rest).condition, 0, round_off);
    const ShearValue value = evaluate(s, x);
    for (int k = 0; k < 4; ++k)
      for (int axis = 0; axis < 3; ++axis) {
        auto plus = x, minus = x;
        plus[k][axis] += difference_step;
        minus[k][axis] -= difference_step;
        const double slope =
            (evaluate(s, plus).condition - evaluate(s, minus).condition) / (2 * difference_step);
        EXPECT_NEAR(value.gradient[k][axis], slope, difference_tolerance);
      }
  }
}
