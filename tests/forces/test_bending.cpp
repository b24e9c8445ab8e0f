// The bending models: what they share, and what each is.
#include "src/forces/angle_bending.hpp"
#include "src/forces/isometric_bending.hpp"
#include "tests/forces/differences.hpp"

#include <Eigen/Geometry>

using namespace taut;
using namespace taut::test;

namespace {

std::vector<HingeStencil> folds(const Bed& b) {
  return folds_of(b.cloth, material.bending, 3 * material.bending);
}

std::unique_ptr<Force> isometric(const Bed& b) {
  return std::make_unique<IsometricBending>(b.cloth, b.pattern, folds(b), 0.0);
}
std::unique_ptr<Force> damped_isometric(const Bed& b) {
  return std::make_unique<IsometricBending>(b.cloth, b.pattern, folds(b), beta);
}
std::unique_ptr<Force> discrete_shells(const Bed& b) {
  return std::make_unique<AngleBending>(b.cloth, folds(b), RestAngle::of_rest_shape, 0.0);
}
std::unique_ptr<Force> damped_shells(const Bed& b) {
  return std::make_unique<AngleBending>(b.cloth, folds(b), RestAngle::of_rest_shape, beta);
}
std::unique_ptr<Force> angle(const Bed& b) {
  return std::make_unique<AngleBending>(b.cloth, folds(b), RestAngle::flat, 0.0);
}

class Bending : public testing::Test {
protected:
  const Bed mixed_{serial(mixed_mesh)}, triangles_{serial(triangle_mesh)};
};

/// Four points whose triangles are far from flat and from collapsed, the angle on either side.
std::array<Vec3, 4> random_hinge(unsigned seed) {
  const auto noise = random_vectors(4, 0.3, seed);
  return {Vec3(0, 0, 0) + noise[0], Vec3(1, 0, 0) + noise[1], Vec3(0.4, 1, 0.5) + noise[2],
          Vec3(0.6, -1, seed % 2 ? 0.7 : -1.5) + noise[3]};
}

/// The rows d theta / dx of all folds.
Dense angle_gradients(const Bed& bed, const WholeState& whole) {
  const DistributedMesh& mesh = bed.cloth.mesh;
  const auto all = folds(bed);
  const State state = bed.at(whole);
  Dense rows = Dense::Zero(Global(all.size()), 3 * mesh.vertices.total);
  for (std::size_t k = 0; k < all.size(); ++k) {
    const auto gradient = spread(all[k], dihedral(all[k].corners(state.positions)).gradient);
    for (int i = 0; i < 6; ++i)
      rows.block<1, 3>(Global(k), 3 * mesh.vertices.original[all[k].vertices[i]]) +=
          std::sqrt(all[k].stiffness) * gradient[i].transpose();
  }
  return rows;
}

} // namespace

TEST(Dihedral, IsTheAngleBetweenTheNormals) {
  for (const double a : {0.0, 0.3, 1.5, 3.0, -0.3, -1.5, -3.0}) {
    const Eigen::AngleAxisd turn(a, Vec3::UnitX());
    const Dihedral d = dihedral({Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0.3, 1, 0), turn * Vec3(0.6, -2, 0)});
    EXPECT_NEAR(d.angle, a, 1e-14);
  }
}

TEST(Dihedral, GradientIsTheDerivativeOfTheAngle) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    const auto x = random_hinge(seed);
    const Dihedral d = dihedral(x);
    for (int k = 0; k < 4; ++k)
      for (int axis = 0; axis < 3; ++axis) {
        auto plus = x, minus = x;
        plus[k][axis] += 1e-5;
        minus[k][axis] -= 1e-5;
        EXPECT_NEAR(d.gradient[k][axis], (dihedral(plus).angle - dihedral(minus).angle) / 2e-5, 1e-7);
      }
  }
}

TEST(Dihedral, OfACollapsedTriangleIsNone) {
  const Dihedral d = dihedral({Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0.3, 0, 0), Vec3(0.6, -2, 0)});
  EXPECT_EQ(d.angle, 0);
  for (const Vec3& g : d.gradient) EXPECT_EQ(g.norm(), 0);
}

TEST_F(Bending, ForcesAreGradientsOfEnergies) {
  for (const Bed* bed : {&mixed_, &triangles_})
    for (const MakeForce make : {isometric, discrete_shells, angle}) expect_force_is_gradient(*bed, make);
}

TEST_F(Bending, ForcesDoNotDependOnThePartition) {
  for (const MakeForce make : {damped_isometric, damped_shells, angle}) {
    expect_same_on_any_partition(mixed_mesh, mixed_, make);
    expect_same_on_any_partition(triangle_mesh, triangles_, make);
  }
}

TEST_F(Bending, StiffnessOfTheIsometricModelIsTheHessian) {
  for (const Bed* bed : {&mixed_, &triangles_}) {
    const WholeState state = random_state(*bed, 0);
    EXPECT_LT(relative_error(step_of(*bed, isometric, state, 1.0).matrix, hessian_of(*bed, isometric, state)),
              difference_tolerance);
  }
}

// k d d^T: the whole Hessian where no edge is bent, and nothing but that elsewhere.
TEST_F(Bending, StiffnessOfAnglesIsTheHessianWithoutItsSecondTerm) {
  for (const Bed* bed : {&mixed_, &triangles_}) {
    WholeState rest = random_state(*bed, 0);
    for (Local i = 0; i < bed->cloth.mesh.vertices.owned; ++i)
      rest.positions[bed->cloth.mesh.vertices.original[i]] = bed->cloth.mesh.rest_positions[i];
    EXPECT_LT(relative_error(step_of(*bed, discrete_shells, rest, 1.0).matrix,
                             hessian_of(*bed, discrete_shells, rest)),
              1e-6);
    for (unsigned seed = 0; seed < states; ++seed) {
      const WholeState state = random_state(*bed, seed);
      const Dense rows = angle_gradients(*bed, state);
      EXPECT_LT(relative_error(step_of(*bed, angle, state, 1.0).matrix, rows.transpose() * rows), 1e-12);
    }
  }
}

TEST_F(Bending, DampingIsProportionalToTheStiffness) {
  constexpr double h = 0.013;
  const WholeState state = random_state(triangles_, 0);
  for (const auto& [damped, bare] :
       {std::pair<MakeForce, MakeForce>{damped_isometric, isometric}, {damped_shells, discrete_shells}})
    EXPECT_LT(relative_error(step_of(triangles_, damped, state, h).matrix,
                             (h * h + h * beta) * step_of(triangles_, bare, state, 1.0).matrix),
              10 * round_off);
}

TEST_F(Bending, RestShapeOfDiscreteShellsIsAtRest) {
  const auto& mesh = triangles_.cloth.mesh;
  WholeState rest = random_state(triangles_, 0);
  for (Local i = 0; i < mesh.vertices.owned; ++i)
    rest.positions[mesh.vertices.original[i]] = mesh.rest_positions[i];
  EXPECT_GT(largest_rest_angle(triangles_.cloth, folds(triangles_)), 0.1);
  EXPECT_EQ(discrete_shells(triangles_)->energy(triangles_.at(rest)), 0);
  EXPECT_GT(angle(triangles_)->energy(triangles_.at(rest)), 0);
}

namespace {

/// A sheet on a cylinder whose axis makes the angle `axis` with y: the arc length is kept.
WholeState on_cylinder(const Bed& bed, double curvature, double axis) {
  const DistributedMesh& mesh = bed.cloth.mesh;
  WholeState state = random_state(bed, 0);
  for (Local i = 0; i < mesh.vertices.owned; ++i) {
    const Vec3& x = mesh.rest_positions[i];
    const double s = std::cos(axis) * x[0] + std::sin(axis) * x[1],
                 t = -std::sin(axis) * x[0] + std::cos(axis) * x[1];
    state.positions[mesh.vertices.original[i]] =
        Vec3(std::sin(curvature * s) / curvature, t, (1 - std::cos(curvature * s)) / curvature);
  }
  return state;
}

/// n x n rhombs of side 1, each cut into two equilateral triangles.
MeshSlab equilateral(MPI_Comm comm, int n) {
  const MeshSlab grid =
      make_grid(self, {double(n), double(n)}, {n + 1, n + 1}, GridCells::alternating_triangles);
  std::vector<Cell> cells;
  for (Global row = 0; row < n; ++row)
    for (Global column = 0; column < n; ++column) {
      const Global a = row * (n + 1) + column, b = a + 1, c = a + n + 1, d = c + 1;
      cells.push_back({{a, b, c, -1}});
      cells.push_back({{b, d, c, -1}});
    }
  std::vector<Vec3> points = grid.rest_positions;
  for (Vec3& x : points) x = Vec3(x[0] + 0.5 * x[1], std::sqrt(0.75) * x[1], 0);
  return slab_of_whole(comm, points, cells);
}

/// The energy density over B/2 kappa^2 of an endless sheet: with E(n) = a n^2 - b n, border effects b n drop
/// out of E(2n) - 2 E(n) = 2 a n^2.
double rigidity(const std::function<MeshSlab(MPI_Comm, int)>& make_mesh, double cell_area,
                const std::function<std::unique_ptr<Force>(const Bed&)>& make, double axis) {
  constexpr double curvature = 1e-3;
  constexpr int n = 8;
  std::array<double, 2> energy;
  for (int k = 0; k < 2; ++k) {
    const Bed bed(serial([&](MPI_Comm comm) { return make_mesh(comm, (k + 1) * n); }));
    energy[k] = make(bed)->energy(bed.at(on_cylinder(bed, curvature, axis)));
  }
  return (energy[1] - 2 * energy[0]) / (2 * n * n * cell_area) / (0.5 * curvature * curvature);
}

MeshSlab square_grid(MPI_Comm comm, int n, GridCells cells) {
  return make_grid(comm, {double(n), double(n)}, {n + 1, n + 1}, cells);
}

using Model = std::function<std::unique_ptr<Force>(const Bed&)>;
Model with(double warp, double weft, int which) {
  return [=](const Bed& b) -> std::unique_ptr<Force> {
    const auto all = folds_of(b.cloth, warp, weft);
    if (which == 0) return std::make_unique<IsometricBending>(b.cloth, b.pattern, all, 0.0);
    return std::make_unique<AngleBending>(b.cloth, all,
                                          which == 1 ? RestAngle::of_rest_shape : RestAngle::flat, 0.0);
  };
}

} // namespace

// Whatever the model and the mesh, a sheet on a cylinder along warp or weft has the energy B/2 kappa^2 per
// area; on equilateral triangles in every direction. Quads do not feel twist: at 45 degrees it is half. A
// grid cut along one diagonal is three times too stiff when that diagonal is rolled up, one cut along both in
// turn one and a half times.
TEST(Cylinder, HasTheSameEnergyForEveryModelAndMesh) {
  constexpr double b = 0.7, diagonal = M_PI / 4;
  for (const int which : {0, 1, 2}) {
    const Model model = with(b, b, which);
    for (const double axis : {0.0, 0.3, diagonal, M_PI / 2})
      EXPECT_NEAR(rigidity(equilateral, std::sqrt(0.75), model, axis) / b, 1, 1e-4);
    for (const auto& [cells, askew] : {std::pair{GridCells::quads, 0.5}, std::pair{GridCells::triangles, 3.0},
                                       std::pair{GridCells::alternating_triangles, 1.5}}) {
      const auto mesh = [cells = cells](MPI_Comm comm, int n) { return square_grid(comm, n, cells); };
      EXPECT_NEAR(rigidity(mesh, 1, model, 0) / b, 1, 1e-4);
      EXPECT_NEAR(rigidity(mesh, 1, model, M_PI / 2) / b, 1, 1e-4);
      EXPECT_NEAR(rigidity(mesh, 1, model, diagonal) / b, askew, 1e-4);
    }
  }
  const auto quads = [](MPI_Comm comm, int n) { return square_grid(comm, n, GridCells::quads); };
  const Model yarn = [b](const Bed& bed) -> std::unique_ptr<Force> {
    return std::make_unique<YarnBending>(bed.cloth, bed.pattern, Threads::all, b, 0.0);
  };
  for (const double axis : {0.0, M_PI / 2}) EXPECT_NEAR(rigidity(quads, 1, yarn, axis) / b, 1, 1e-4);
}

TEST(Cylinder, WarpAndWeftBendByTheirOwnStiffness) {
  for (const int which : {0, 1, 2})
    for (const GridCells cells : {GridCells::quads, GridCells::triangles}) {
      const auto mesh = [cells](MPI_Comm comm, int n) { return square_grid(comm, n, cells); };
      EXPECT_NEAR(rigidity(mesh, 1, with(2, 5, which), 0), 2, 1e-3);        // axis along y: warp bends
      EXPECT_NEAR(rigidity(mesh, 1, with(2, 5, which), M_PI / 2), 5, 1e-3); // axis along x: weft bends
    }
}
