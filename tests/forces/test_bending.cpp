// The bending models: what they share, and what each is.
#include "src/forces/angle_bending.hpp"
#include "src/forces/isometric_bending.hpp"
#include "src/forces/twist.hpp"
#include "tests/forces/differences.hpp"

#include <Eigen/Geometry>

using namespace taut;
using namespace taut::test;

namespace {

Folds folds(const Bed& b) {
  return folds_of(b.cloth, Rigidity{material.bending, 3 * material.bending, 2 * material.bending});
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

std::unique_ptr<Force> twist(const Bed& b) {
  return std::make_unique<Twist>(b.cloth, b.pattern, material.bending, 0.0);
}
std::unique_ptr<Force> damped_twist(const Bed& b) {
  return std::make_unique<Twist>(b.cloth, b.pattern, material.bending, beta);
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

/// All rows d z / dx of which the energy of angles is made: those of folds alone and those of triangles.
Dense angle_gradients(const Bed& bed, const WholeState& whole) {
  const DistributedMesh& mesh = bed.cloth.mesh;
  const Folds all = folds(bed);
  const State state = bed.at(whole);
  Dense rows = Dense::Zero(Global(all.hinges.size() + 3 * all.triangles.size()), 3 * mesh.vertices.total);
  const auto add = [&](Global row, const HingeStencil& f, double weight) {
    const auto gradient = spread(f, dihedral(f.corners(state.positions)).gradient);
    for (int i = 0; i < 6; ++i)
      rows.block<1, 3>(row, 3 * mesh.vertices.original[f.vertices[i]]) += weight * gradient[i].transpose();
  };
  Global row = 0;
  for (const HingeStencil& f : all.hinges) add(row++, f, std::sqrt(f.stiffness));
  for (const TriangleStencil& t : all.triangles)
    for (const auto& weights : t.rows) {
      for (int k = 0; k < 3 && t.folds[k] >= 0; ++k) {
        const HingeStencil& f = all.hinges[t.folds[k]];
        add(row, f, weights[k] * f.length() / f.area);
      }
      ++row;
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
  expect_force_is_gradient(mixed_, twist);
}

TEST_F(Bending, ForcesDoNotDependOnThePartition) {
  for (const MakeForce make : {damped_isometric, damped_shells, angle}) {
    expect_same_on_any_partition(mixed_mesh, mixed_, make);
    expect_same_on_any_partition(triangle_mesh, triangles_, make);
  }
  expect_same_on_any_partition(mixed_mesh, mixed_, damped_twist);
}

TEST_F(Bending, StiffnessOfQuadraticFormsIsTheHessian) {
  const auto expect_hessian = [](const Bed& bed, MakeForce make) {
    const WholeState state = random_state(bed, 0);
    EXPECT_LT(relative_error(step_of(bed, make, state, 1.0).matrix, hessian_of(bed, make, state)),
              difference_tolerance);
  };
  for (const Bed* bed : {&mixed_, &triangles_}) expect_hessian(*bed, isometric);
  expect_hessian(mixed_, twist);
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
  const WholeState state = random_state(triangles_, 0), state_of_mixed = random_state(mixed_, 0);
  for (const auto& [damped, bare] :
       {std::pair<MakeForce, MakeForce>{damped_isometric, isometric}, {damped_shells, discrete_shells}})
    EXPECT_LT(relative_error(step_of(triangles_, damped, state, h).matrix,
                             (h * h + h * beta) * step_of(triangles_, bare, state, 1.0).matrix),
              10 * round_off);
  EXPECT_LT(relative_error(step_of(mixed_, damped_twist, state_of_mixed, h).matrix,
                           (h * h + h * beta) * step_of(mixed_, twist, state_of_mixed, 1.0).matrix),
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

/// The energy density over B/2 kappa^2 of an endless sheet: with E(n) = a n^2 + b n + c, borders and corners
/// drop out of E(3n) - 2 E(2n) + E(n) = 2 a n^2.
double rigidity(const std::function<MeshSlab(MPI_Comm, int)>& make_mesh, double cell_area,
                const std::function<std::unique_ptr<Force>(const Bed&)>& make, double axis) {
  constexpr double curvature = 1e-3;
  constexpr int n = 5;
  std::array<double, 3> energy;
  for (int k = 0; k < 3; ++k) {
    const Bed bed(serial([&](MPI_Comm comm) { return make_mesh(comm, (k + 1) * n); }));
    energy[k] = make(bed)->energy(bed.at(on_cylinder(bed, curvature, axis)));
  }
  return (energy[2] - 2 * energy[1] + energy[0]) / (2 * n * n * cell_area) / (0.5 * curvature * curvature);
}

MeshSlab square_grid(MPI_Comm comm, int n, GridCells cells) {
  return make_grid(comm, {double(n), double(n)}, {n + 1, n + 1}, cells);
}

using Model = std::function<std::unique_ptr<Force>(const Bed&)>;
Model with(double warp, double weft, int which) {
  return [=](const Bed& b) -> std::unique_ptr<Force> {
    const Folds all = folds_of(b.cloth, Rigidity{warp, weft, std::sqrt(warp * weft)});
    if (which == 0) return std::make_unique<IsometricBending>(b.cloth, b.pattern, all, 0.0);
    return std::make_unique<AngleBending>(b.cloth, all,
                                          which == 1 ? RestAngle::of_rest_shape : RestAngle::flat, 0.0);
  };
}

} // namespace

// Whatever the model and the mesh, a sheet on a cylinder along warp or weft has the energy B/2 kappa^2 per
// area; on triangles in every direction, but for an eighth where squares are cut in turn. The folds of quads
// do not feel twist: at 45 degrees it is half.
TEST(Cylinder, HasTheSameEnergyForEveryModelAndMesh) {
  constexpr double b = 0.7, diagonal = M_PI / 4;
  for (const int which : {0, 1, 2}) {
    const Model model = with(b, b, which);
    for (const double axis : {0.0, 0.3, diagonal, M_PI / 2})
      EXPECT_NEAR(rigidity(equilateral, std::sqrt(0.75), model, axis) / b, 1, 1e-4);
    for (const auto& [cells, askew] : {std::pair{GridCells::quads, 0.5}, std::pair{GridCells::triangles, 1.0},
                                       std::pair{GridCells::alternating_triangles, 1.125}}) {
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

// Along a seam a fold by theta stores S/2 theta^2 a metre of it and metre of cloth around it, and the cloth's
// own B where S is less, or where there is no seam.
TEST(Seam, BendsWithItsOwnStiffnessWhereThatIsLarger) {
  constexpr double theta = 1e-3, b = 0.7;
  Bed bed(serial([](MPI_Comm comm) { return square_grid(comm, 4, GridCells::quads); }));
  bed.cloth.pieces[0].parts.seams = {{"a.1-b.3", {2, 7, 12, 17, 22}}}; // x = 2
  const auto energy = [&](int which, double seam, double fold) {
    const Folds all = folds_of(bed.cloth, Rigidity{b, b, b, seam});
    WholeState state = random_state(bed, 0);
    for (Local i = 0; i < bed.cloth.mesh.vertices.owned; ++i) {
      const Vec3& x = bed.cloth.mesh.rest_positions[i];
      const double turned = std::max(x[0] - fold, 0.0);
      state.positions[bed.cloth.mesh.vertices.original[i]] =
          Vec3(std::min(x[0], fold) + std::cos(theta) * turned, x[1], std::sin(theta) * turned);
    }
    if (which == 0) return IsometricBending(bed.cloth, bed.pattern, all, 0.0).energy(bed.at(state));
    return AngleBending(bed.cloth, all, RestAngle::flat, 0.0).energy(bed.at(state));
  };
  const double of_one = 4 * 0.5 * theta * theta; // four sides of 1 m, each between squares of 1 m
  for (const int which : {0, 1}) {
    EXPECT_NEAR(energy(which, 10 * b, 2) / of_one, 10 * b, 1e-5);
    EXPECT_NEAR(energy(which, 0.1 * b, 2) / of_one, b, 1e-6);
    EXPECT_NEAR(energy(which, 10 * b, 1) / of_one, b, 1e-6);
  }
}

// A plate: what is twisted by s has the energy T s^2 per area, what is bent along warp or weft none, and at
// rest a trapezium has none either, however it lies.
TEST(TwistOfAQuad, IsThatOfAPlate) {
  const auto quads = [](MPI_Comm comm, int n) { return square_grid(comm, n, GridCells::quads); };
  const Bed bed(serial([&](MPI_Comm comm) { return quads(comm, 4); }));
  const auto energy_at = [&](const std::function<double(double, double)>& height) {
    WholeState state = random_state(bed, 0);
    for (Local i = 0; i < bed.cloth.mesh.vertices.owned; ++i) {
      const Vec3& x = bed.cloth.mesh.rest_positions[i];
      state.positions[bed.cloth.mesh.vertices.original[i]] = Vec3(x[0], x[1], height(x[0], x[1]));
    }
    return Twist(bed.cloth, bed.pattern, 0.7, 0.0).energy(bed.at(state));
  };
  EXPECT_NEAR(energy_at([](double x, double y) { return 0.01 * x * y; }), 16 * 0.7 * 1e-4, 1e-12);
  EXPECT_NEAR(energy_at([](double x, double y) { return 0.01 * (x * x - y * y) + 0.3 * x; }), 0, 1e-18);

  const std::array<Vec3, 4> trapezium{Vec3(0, 0, 0), Vec3(3, 0, 0), Vec3(2, 1, 0), Vec3(1, 1.2, 0)};
  const auto c = twist_weights(trapezium);
  Vec3 sum = Vec3::Zero();
  for (int k = 0; k < 4; ++k) sum += c[k] * trapezium[k];
  EXPECT_LT(sum.norm(), 1e-15);
  EXPECT_NEAR(c[0] + c[1] + c[2] + c[3], 0, 1e-15);
}

// Yarns and twist together make a sheet whose rigidity is the same in every direction.
TEST(Cylinder, OfYarnsWithTwistHasTheSameEnergyInAllDirections) {
  const auto quads = [](MPI_Comm comm, int n) { return square_grid(comm, n, GridCells::quads); };
  for (const double axis : {0.0, 0.3, M_PI / 4, M_PI / 2}) {
    double sum = 0;
    for (const Model& model : {Model([](const Bed& bed) -> std::unique_ptr<Force> {
                                 return std::make_unique<YarnBending>(bed.cloth, bed.pattern, Threads::all,
                                                                      1.0, 0.0);
                               }),
                               Model([](const Bed& bed) -> std::unique_ptr<Force> {
                                 return std::make_unique<Twist>(bed.cloth, bed.pattern, 1.0, 0.0);
                               })})
      sum += rigidity(quads, 1, model, axis);
    EXPECT_NEAR(sum, 1, 1e-4);
  }
}

namespace {

/// A flat sheet of triangles, each two of them mirror images, askew to warp and weft by `turn`; the texture
/// shows it from behind if `mirrored`.
MeshSlab askew(MPI_Comm comm, double turn, bool mirrored) {
  const MeshSlab grid = make_grid(self, {1.0, 1.0}, {7, 7}, GridCells::triangles);
  std::vector<Vec3> points = grid.rest_positions;
  for (Vec3& x : points) x = Vec3(1.2 * x[0] + 0.4 * x[1], 0.8 * x[1] - 0.1 * x[0], 0);
  MeshSlab mesh = slab_of_whole(comm, points, grid.cell);
  const Eigen::Rotation2Dd rotation(turn);
  for (const Cell& c : mesh.cell) {
    Corners2& corners = mesh.texture.emplace_back();
    for (int k = 0; k < 4; ++k) {
      corners[k] = rotation * Vec2(points[c.vertices[k < 3 ? k : 0]].head<2>());
      if (mirrored) corners[k][0] = -corners[k][0];
    }
  }
  return mesh;
}

/// The energy of a triangle whose z are those of the function x H x / 2 of its rest shape.
double energy_of_quadratic(const TriangleStencil& t, const Folds& folds, const Eigen::Matrix2d& hessian) {
  double energy = 0;
  for (const auto& row : t.rows) {
    double sum = 0;
    for (int side = 0; side < 3; ++side) {
      const HingeStencil& f = folds.hinges[t.folds[side]];
      const auto weights = isometric_row(f.rest);
      for (int c = 0; c < 4; ++c) {
        const Vec2 x = f.rest[c].head<2>();
        sum += row[side] / f.area * weights[c] * 0.5 * x.dot(hessian * x);
      }
    }
    energy += 0.5 * sum * sum;
  }
  return energy;
}

} // namespace

// The patch test, in the axes of warp and weft, whichever way a texture shows them.
TEST(TriangleFolds, KnowTheEnergyOfAnOrthotropicPlate) {
  const Eigen::Matrix2d hessian = (Eigen::Matrix2d() << 0.7, -0.4, -0.4, 1.1).finished();
  for (const double turn : {0.0, 0.5})
    for (const bool mirrored : {false, true}) {
      const Bed bed(serial([&](MPI_Comm comm) { return askew(comm, turn, mirrored); }));
      const Folds folds = folds_of(bed.cloth, Rigidity{2, 5, 3});
      const Eigen::Matrix2d axes = Eigen::Rotation2Dd(turn).toRotationMatrix(),
                            k = axes * hessian * axes.transpose();
      const double density =
          0.5 * (2 * k(0, 0) * k(0, 0) + 5 * k(1, 1) * k(1, 1) + 2 * 3 * k(0, 1) * k(0, 1));
      int within = 0;
      for (const TriangleStencil& t : folds.triangles) {
        if (t.folds[2] < 0) continue;
        const auto& x = bed.cloth.mesh.rest_positions;
        const auto& v = t.vertices;
        const double area = 0.5 * (x[v[1]] - x[v[0]]).cross(x[v[2]] - x[v[0]]).norm();
        EXPECT_NEAR(energy_of_quadratic(t, folds, hessian) / (area * density), 1, 1e-9);
        ++within;
      }
      EXPECT_EQ(within, 50); // of 72: 24 sides lie at the border, two of them at one triangle in two corners
    }
}
