#pragma once
#include "partition/distributed_mesh.hpp"
#include "src/constraints/constraint_set.hpp"
#include "src/linear/bounded_qp.hpp"
#include "src/linear/solver_options.hpp"

#include <algorithm>
#include <cmath>

namespace taut {

/// product = (J W J^T + a) z with the inverse metric W of local vertices, as the set's spread and difference
/// make it; `push` is room for a field of local vertices. Collective.
template<class Set>
void multiply_matrix_free(const DistributedMesh& mesh, Set& set, std::span<const double> metric,
                          std::span<const double> z, std::span<double> product, std::vector<Vec3>& push) {
  std::fill(push.begin(), push.end(), Vec3::Zero());
  set.begin_spread(z);
  set.end_spread(push);
  for (Local i = 0; i < mesh.vertices.owned; ++i) push[i] = metric[i] * set.freedom().allowed(i, push[i]);
  mesh.vertex_halo.update(push);
  const auto compliance = set.program_compliance();
  for (std::size_t r = 0; r < product.size(); ++r) product[r] = compliance[r] * z[r];
  set.subtract_difference(push, product);
}

/// What ConstraintSet::solve asks, for a set whose rows have no matrix: conjugate gradients (BoundedQp) on J
/// W J^T + a, as the set's spread, difference and precondition make them, until no row has more left than
/// `tolerance` times the largest at the start. The change is added to the set. Collective.
template<class Set>
SolveReport solve_matrix_free(const DistributedMesh& mesh, Set& set, double tolerance) {
  constexpr int most_products = 1000;
  std::vector<double> rhs(set.rows()), change(set.rows(), 0.0), left(set.rows()), lower, upper;
  std::vector<Vec3> push(mesh.vertices.size());
  set.factor(set.inverse_mass());
  set.residual(rhs);
  double largest = 0;
  for (const double c : rhs) largest = std::max(largest, std::abs(c));
  std::fill(left.begin(), left.end(), std::max(tolerance * max_over(mesh.comm, largest), 1e-300));
  const auto multiply = [&](std::span<const double> z, std::span<double> product) {
    multiply_matrix_free(mesh, set, set.inverse_mass(), z, product, push);
  };
  const auto precondition = [&](std::span<const double> r, std::span<double> s) { set.precondition(r, s); };
  const std::size_t equations = bound_rows(set, lower, upper);
  const BoundedQp program{multiply, precondition, rhs, equations, lower, upper, left};
  const QpReport solved = solve(mesh.comm, program, {most_products}, change);
  set.add(change);
  return {solved.products, solved.solved ? "" : "conjugate gradients did not converge"};
}

} // namespace taut
