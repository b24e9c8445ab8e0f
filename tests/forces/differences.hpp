#pragma once
// Derivatives of forces by central differences.
#include "tests/force_bed.hpp"

namespace taut::test {

inline constexpr unsigned states = 3; ///< random ones, for every check

// Relative. Central differences of polynomials of degree four over edges of 0.2 m, with a step of 1e-5 m, err
// by (1e-5/0.2)^2 = 3e-9 through its length and by 1e-16/1e-5 = 1e-11 through rounding.
inline constexpr double difference_step = 1e-5; // m
inline constexpr double difference_tolerance = 1e-7;

inline Column force_of(const Bed& bed, MakeForce make, const WholeState& state) {
  StepSystem system(bed.pattern, bed.cloth.mesh.vertices.size());
  system.start(1.0);
  make(bed)->add_to(system, bed.at(state));
  return whole_rhs(bed, system);
}

/// Of a function of a state, by all coordinates.
template<class Function>
Dense derivative(const Function& function, const WholeState& state) {
  Dense derivative(function(state).size(), 3 * Global(state.positions.size()));
  for (Global c = 0; c < derivative.cols(); ++c) {
    WholeState plus = state, minus = state;
    plus.positions[c / 3][c % 3] += difference_step;
    minus.positions[c / 3][c % 3] -= difference_step;
    derivative.col(c) = (function(plus) - function(minus)) / (2 * difference_step);
  }
  return derivative;
}

inline Dense hessian_of(const Bed& whole, MakeForce make, const WholeState& state) {
  return -derivative([&](const WholeState& s) { return force_of(whole, make, s); }, state);
}

/// That the force is minus the gradient of the energy, in random states.
inline void expect_force_is_gradient(const Bed& whole, MakeForce make) {
  for (unsigned seed = 0; seed < states; ++seed) {
    const auto energy = [&](const WholeState& s) {
      return Column(Column::Constant(1, make(whole)->energy(whole.at(s))));
    };
    const WholeState state = random_state(whole, seed);
    const Column expected = -derivative(energy, state).transpose();
    EXPECT_LT(relative_error(force_of(whole, make, state), expected), difference_tolerance);
  }
}

/// That on any partition forces come out to the last bit as on one rank, the stiffness to round-off, and
/// energies add up.
inline void expect_same_on_any_partition(const MakeMesh& make_mesh, const Bed& whole, MakeForce make) {
  constexpr double h = 0.013;
  const WholeState state = random_state(whole, 0);
  const Step expected = step_of(whole, make, state, h);
  const double energy = make(whole)->energy(whole.at(state));
  on_odd_partitions(make_mesh, [&](DistributedMesh mesh) {
    const Bed bed(std::move(mesh));
    const Step step = step_of(bed, make, state, h);
    EXPECT_EQ((step.rhs - expected.rhs).cwiseAbs().maxCoeff(), 0.0);
    EXPECT_LT(relative_error(step.matrix, expected.matrix), round_off);
    EXPECT_NEAR(sum_over(world, make(bed)->energy(bed.at(state))), energy, 10 * round_off * energy);
  });
}

inline void expect_semi_definite(const Bed& whole, MakeForce make) {
  for (unsigned seed = 0; seed < states; ++seed) {
    const Dense k = step_of(whole, make, random_state(whole, seed), 1.0).matrix;
    EXPECT_LT(relative_error(k.transpose(), k), round_off);
    const Column eigenvalues = Eigen::SelfAdjointEigenSolver<Dense>(k, Eigen::EigenvaluesOnly).eigenvalues();
    EXPECT_GT(eigenvalues[0], -round_off * eigenvalues[eigenvalues.size() - 1]);
  }
}

} // namespace taut::test
