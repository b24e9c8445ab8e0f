// Forces of single faces: stretch of warp and weft, shear, diagonals.
#include "src/forces/diagonal_springs.hpp"
#include "src/forces/stretch.hpp"
#include "src/state/material_coordinates.hpp"
#include "tests/forces/differences.hpp"

using namespace taut;
using namespace taut::test;

namespace {

const StretchMaterial elastic{{90, 60}, {1.05, 0.9}, 0.0, 0.4};

std::unique_ptr<Force> stretch(const Bed& b) {
  return std::make_unique<Stretch>(b.cloth, b.pattern, elastic);
}
std::unique_ptr<Force> damped_stretch(const Bed& b) {
  return std::make_unique<Stretch>(b.cloth, b.pattern,
                                   StretchMaterial{elastic.stiffness, elastic.target, beta});
}
std::unique_ptr<Force> diagonals(const Bed& b) {
  return std::make_unique<DiagonalSprings>(b.cloth, b.pattern, material.shear, 0.0);
}
std::unique_ptr<Force> damped_diagonals(const Bed& b) {
  return std::make_unique<DiagonalSprings>(b.cloth, b.pattern, material.shear, beta);
}

class Faces : public testing::Test {
protected:
  const Bed mixed_{serial(mixed_mesh)}, triangles_{serial(triangle_mesh)};
};

/// Adds scale c c^T (x) block to a whole matrix.
void add_block(const DistributedMesh& mesh, std::span<const Local> v, std::span<const double> c,
               const Mat3& block, Dense& all) {
  for (std::size_t a = 0; a < v.size(); ++a)
    for (std::size_t b = 0; b < v.size(); ++b)
      all.block<3, 3>(3 * mesh.vertices.original[v[a]], 3 * mesh.vertices.original[v[b]]) +=
          c[a] * c[b] * block;
}

/// What Stretch leaves out of its Hessian: T/|w| c c^T (x) (I - n n^T) where the tension T is negative. (It
/// never cuts off more than k, for T/|w| < k without damping.)
Dense left_out_of_stretch(const Bed& bed, const WholeState& whole) {
  const DistributedMesh& mesh = bed.cloth.mesh;
  const State state = bed.at(whole);
  Dense all = Dense::Zero(3 * mesh.vertices.total, 3 * mesh.vertices.total);
  for (const Tangent& t : tangents_of(bed.cloth)) {
    const Vec3 w = tangent(t.stencil, state.positions), n = w.normalized();
    const double tension = elastic.compression * elastic.stiffness[t.direction] * t.measure *
                           (w.norm() - elastic.target[t.direction]);
    if (tension < 0)
      add_block(mesh, t.stencil.vertices, t.stencil.c,
                tension / w.norm() * (Mat3::Identity() - n * n.transpose()), all);
  }
  return all;
}

/// A rectangle of lu x lv, cut into cells, and moved by `place`.
WholeState placed(const Bed& bed, const std::function<Vec3(const Vec3&)>& place) {
  WholeState state = random_state(bed, 0);
  for (Local i = 0; i < bed.cloth.mesh.vertices.owned; ++i)
    state.positions[bed.cloth.mesh.vertices.original[i]] = place(bed.cloth.mesh.rest_positions[i]);
  return state;
}

} // namespace

TEST_F(Faces, ForcesAreGradientsOfEnergies) {
  for (const MakeForce make : {stretch, diagonals}) expect_force_is_gradient(mixed_, make);
  for (const MakeForce make : {stretch, shear}) expect_force_is_gradient(triangles_, make);
}

TEST_F(Faces, ForcesDoNotDependOnThePartition) {
  for (const MakeForce make : {damped_stretch, damped_diagonals, damped_shear})
    expect_same_on_any_partition(mixed_mesh, mixed_, make);
  for (const MakeForce make : {damped_stretch, damped_shear})
    expect_same_on_any_partition(triangle_mesh, triangles_, make);
}

TEST_F(Faces, StiffnessIsSemiDefinite) {
  for (const MakeForce make : {damped_stretch, damped_diagonals}) expect_semi_definite(mixed_, make);
  for (const MakeForce make : {damped_stretch, damped_shear}) expect_semi_definite(triangles_, make);
}

TEST_F(Faces, StiffnessOfStretchIsTheHessianWithoutCompression) {
  for (const Bed* bed : {&mixed_, &triangles_})
    for (unsigned seed = 0; seed < states; ++seed) {
      const WholeState state = random_state(*bed, seed);
      const Dense hessian = hessian_of(*bed, stretch, state),
                  expected = hessian - left_out_of_stretch(*bed, state);
      EXPECT_GT(relative_error(hessian, expected), 0.01); // there is something to leave out
      EXPECT_LT(relative_error(step_of(*bed, stretch, state, 1.0).matrix, expected),
                10 * difference_tolerance);
    }
}

// Twice the rest shape: every tangent is longer than its target, every diagonal pulls.
TEST_F(Faces, StiffnessUnderTensionIsTheWholeHessian) {
  for (const MakeForce make : {stretch, diagonals}) {
    const WholeState state = placed(mixed_, [](const Vec3& x) { return Vec3(2 * x); });
    EXPECT_LT(relative_error(step_of(mixed_, make, state, 1.0).matrix, hessian_of(mixed_, make, state)),
              10 * difference_tolerance);
  }
}

namespace {

/// sqrt(k a) (|w| - b) of all tangents: the energy is half the sum of squares.
Column conditions(const Bed& bed, const WholeState& state) {
  const auto tangents = tangents_of(bed.cloth);
  const State s = bed.at(state);
  Column c(tangents.size());
  for (std::size_t k = 0; k < tangents.size(); ++k) {
    const Tangent& t = tangents[k];
    c[Global(k)] = std::sqrt(elastic.stiffness[t.direction] * t.measure) *
                   (tangent(t.stencil, s.positions).norm() - elastic.target[t.direction]);
  }
  return c;
}

/// sum f dC/dx with given f over all tangents.
Column pull(const Bed& bed, const WholeState& state, const Column& f) {
  const auto tangents = tangents_of(bed.cloth);
  const State s = bed.at(state);
  Column sum = Column::Zero(3 * Global(state.positions.size()));
  for (std::size_t k = 0; k < tangents.size(); ++k) {
    const Tangent& t = tangents[k];
    const double root = std::sqrt(elastic.stiffness[t.direction] * t.measure);
    for (int i = 0; i < 3; ++i)
      sum.segment<3>(3 * bed.cloth.mesh.vertices.original[t.stencil.vertices[i]]) +=
          f[Global(k)] * root * t.stencil.c[i] * tangent(t.stencil, s.positions).normalized();
  }
  return sum;
}

} // namespace

// d = -beta dC Cdot with D = -dd/dv = beta dC dC^T; of -dd/dx, Cdot d2C is kept, together with C d2C, where
// their sum is positive.
TEST_F(Faces, DampingActsOnTheRateOfTheConditions) {
  constexpr double h = 0.013;
  for (const Bed* bed : {&mixed_, &triangles_}) {
    WholeState state = random_state(*bed, 1);
    Column velocity(3 * Global(state.positions.size()));
    for (std::size_t i = 0; i < state.velocities.size(); ++i)
      velocity.segment<3>(3 * Global(i)) = state.velocities[i] *= 0.05;
    const Dense rows = derivative([&](const WholeState& s) { return conditions(*bed, s); }, state);
    const Column total = conditions(*bed, state) + beta * rows * velocity;
    const Dense curved =
        derivative([&](const WholeState& s) { return pull(*bed, s, total.cwiseMax(0.0)); }, state);
    const Dense expected = (h * h + h * beta) * rows.transpose() * rows + h * h * curved;
    EXPECT_LT(relative_error(step_of(*bed, damped_stretch, state, h).matrix, expected), 1e-6);
  }
}

TEST_F(Faces, TangentsOfARestShapeHaveLengthOne) {
  for (const Bed* bed : {&mixed_, &triangles_})
    for (const Tangent& t : tangents_of(bed->cloth))
      EXPECT_NEAR(tangent(t.stencil, bed->cloth.mesh.rest_positions).norm(), 1, 1e-12);
}

TEST_F(Faces, StretchOfAStripIsThatOfAnElasticSheet) {
  for (const GridCells cells : {GridCells::quads, GridCells::triangles, GridCells::alternating_triangles}) {
    const Bed bed(serial([&](MPI_Comm comm) { return make_grid(comm, {2, 1.5}, {6, 5}, cells); }));
    const StretchMaterial sheet{{90, 60}, Vec2::Ones(), 0};
    const Stretch force(bed.cloth, bed.pattern, sheet);
    const WholeState state = placed(bed, [](const Vec3& x) { return Vec3(1.1 * x[0], 0.95 * x[1], 3); });
    EXPECT_NEAR(force.energy(bed.at(state)), 0.5 * 3.0 * (90 * 0.01 + 60 * 0.0025), 1e-12);
  }
}

// A sheet sheared by a small angle g has the energy G A g^2 / 2 by every model and on every mesh.
TEST_F(Faces, ShearStiffnessMeansTheSameForEveryModel) {
  constexpr double g = 1e-3;
  const auto sheared = [](const Vec3& x) { return Vec3(x[0] + g * x[1], x[1], 0); };
  for (const GridCells cells : {GridCells::quads, GridCells::triangles, GridCells::alternating_triangles}) {
    const Bed bed(serial([&](MPI_Comm comm) { return make_grid(comm, {2, 1.5}, {6, 5}, cells); }));
    const double expected = 0.5 * material.shear * 3.0 * g * g;
    const State state = bed.at(placed(bed, sheared));
    EXPECT_NEAR(shear(bed)->energy(state), expected, 1e-2 * expected);
    if (cells == GridCells::quads) {
      EXPECT_NEAR(diagonals(bed)->energy(state), expected, 1e-2 * expected);
    }
  }
}

TEST(MaterialCoordinates, KeepTheRestShapeAndFollowTheTexture) {
  // A triangle standing upright; its texture, in other units, says that warp goes up.
  DistributedMesh mesh = serial([](MPI_Comm comm) {
    return slab_of_whole(comm, {{0, 0, 0}, {0, 2, 0}, {0, 0, 1}}, {{{0, 1, 2, -1}}});
  });
  const auto& v = mesh.cells[0].vertices;
  const auto length = [&](int a, int b) {
    return (mesh.rest_positions[v[a]] - mesh.rest_positions[v[b]]).norm();
  };
  const auto check_lengths = [&](const Corners2& m) {
    for (const auto& [a, b] : {std::pair{0, 1}, std::pair{1, 2}, std::pair{2, 0}})
      EXPECT_NEAR((m[a] - m[b]).norm(), length(a, b), 1e-14);
  };
  const Corners2 plain = material_coordinates(mesh, 0);
  check_lengths(plain);
  EXPECT_NEAR((plain[1] - plain[0] - Vec2(2, 0)).norm(), 0, 1e-14); // x is the normal, so warp runs along y
  mesh.texture = {{Vec2(0, 0), Vec2(0, -20), Vec2(10, 0), Vec2::Zero()}};
  const Corners2 turned = material_coordinates(mesh, 0);
  check_lengths(turned);
  EXPECT_NEAR((turned[2] - turned[0] - Vec2(1, 0)).norm(), 0, 1e-14);
}

TEST(StretchChange, IsTheLargestOfAnyTangent) {
  on_odd_partitions(triangle_mesh, [](DistributedMesh mesh) {
    const Bed bed(std::move(mesh));
    std::vector<Vec3> larger = bed.cloth.mesh.rest_positions;
    for (Vec3& x : larger) x *= 1.25;
    const double change =
        largest_stretch_change(bed.cloth, tangents_of(bed.cloth), bed.cloth.mesh.rest_positions, larger);
    EXPECT_NEAR(change, 0.25, 1e-12);
  });
}
