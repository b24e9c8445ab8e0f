#pragma once
#include "src/linear/row_edge.hpp"
#include "src/linear/solver_options.hpp"
#include "src/state/freedom.hpp"
#include "src/state/state.hpp"

#include <algorithm>
#include <cmath>
#include <concepts>
#include <vector>

namespace taut {

/// What a set of constraints is used for.
enum class ConstraintUse {
  alone,
  with_contact,
  in_newton ///< multipliers of the last step are taken whole, pushes too
};

/// What bounds the compliance of rows.
struct ComplianceBounds {
  double part = HUGE_VAL;   ///< the scaled compliance is at most so much of what the row yields by its masses
  double strain = HUGE_VAL; ///< from which on a row yields only by the logarithm of how hard it is pulled
};

/// With contact programs take few products, and their rows must not be softer than these reach. Alone rows
/// are, or a thread that is pulled straight is not solved; but strain that grows with tension breaks the
/// limit where something pulls hard, and more so in shorter steps, where tension is larger. A compliance that
/// the case gives is the material's, and has no bound; nor has it where contact has the last word, because
/// stiff edges would throw back what it has strained.
inline ComplianceBounds compliance_bounds(const config::Inextensibility& options, ConstraintUse use) {
  if (use == ConstraintUse::with_contact) return {.part = 1e-3};
  if (options.may_bound_compliance) return {.strain = 0.15 * options.strain};
  return {};
}

/// How far a row yields to its multiplier, and by how much more to a larger one: a mu up to about `linear`,
/// then by the logarithm. Without end, so that a thread between two pins can be pulled to any strain.
struct Yield {
  double length, slope;
};
inline Yield yield(double compliance, double mu, double linear) {
  if (std::isinf(linear)) return {compliance * mu, compliance};
  const double part = compliance * mu / linear;
  return {linear * std::asinh(part), compliance / std::sqrt(1 + part * part)};
}

/// Where a row is at rest, and along what it keeps the length.
struct RowPlace {
  Vec3 point;        ///< m
  Vec3 direction;    ///< of length one
  double multiplier; ///< mu of the row where all rows along this direction bear the same tension
};

/// A set of constraints C(x) = a mu on the cloth, with J = dC/dx, scaled compliances a, and multipliers mu =
/// h^2 lambda: what inextensibility keeps, alone (FastProjection), with contact (ContactProjection).
/// Another kind of constraint is another class like EdgeSet and MetricSet, and a line where its methods are
/// instantiated.
///
/// A rank holds the rows that it owns; W are the inverse masses in the directions in which vertices may move.
/// What is said to be collective is so among neighbours at least.
template<class S>
concept ConstraintSet = requires(S set, const S& fixed, const State& start, double number,
                                 const Freedom& freedom, Candidate& candidate, std::span<const Vec3> vertices,
                                 std::span<Vec3> field, std::span<const double> z, std::span<double> rows,
                                 std::span<const double> metric, Local vertex) {
  /// For a step from `start`, with the multipliers that the candidate carries. Not collective.
  set.start(start, number, freedom, candidate);
  /// C and J at positions of local vertices; returns the largest |strain|, infinite if one is not a number.
  /// Collective.
  { set.evaluate(vertices) } -> std::same_as<double>;
  /// The same strain alone. Collective.
  { fixed.strain(vertices) } -> std::same_as<double>;
  /// mu into the candidate, as forces and stresses. Not collective, but for ghosts.
  fixed.finish(candidate);

  /// Alone: (J W J^T + a) d_mu = C - a mu, to the relative tolerance given; d_mu is added to mu.
  /// Collective.
  { set.solve(number) } -> std::same_as<SolveReport>;
  /// W J^T d_mu at an owned vertex, in m. Not collective.
  { fixed.displacement(vertex) } -> std::same_as<Vec3>;

  /// As rows of a quadratic program for increments z of mu (ContactQp): how many this rank owns; a of each, 1
  /// where nothing can move.
  { fixed.rows() } -> std::convertible_to<std::size_t>;
  { fixed.program_compliance() } -> std::convertible_to<std::span<const double>>;
  /// The step may leave this part of the strain that it starts with. Not collective.
  set.keep_strain(number);
  /// C - a mu with C linear in the stretch, which is what moves a row to its length if the cloth keeps its
  /// direction, less what the step may leave.
  fixed.program_residual(rows);
  /// What a part of the strain limit is for each row.
  fixed.program_tolerance(number, rows);
  /// z of the last step's programs, to start from.
  fixed.program_guess(rows);
  /// Prepares `precondition` with the inverse metric W given for local vertices, 0 where they are held.
  /// Collective.
  set.factor(metric);
  /// An approximate solution of (J W J^T + a) s = r. Collective.
  fixed.precondition(z, rows);
  /// field -= J^T z on owned vertices, which come first in it, in two halves around the exchange with
  /// neighbours.
  set.begin_spread(z);
  set.end_spread(field);
  /// rows -= J u, for u over local vertices.
  set.subtract_difference(vertices, rows);
  /// mu += z. Collective.
  set.add(z);

  { fixed.inverse_mass() } -> std::convertible_to<std::span<const double>>; ///< of local vertices, 0 if held
  { fixed.freedom() } -> std::same_as<const Freedom&>;
};

/// A set whose rows behind the first `equations()` are one-sided: increments of their multipliers have
/// bounds.
template<class S>
concept OneSidedSet = ConstraintSet<S> && requires(const S& fixed, std::span<double> rows) {
  { fixed.equations() } -> std::convertible_to<std::size_t>;
  fixed.program_bounds(rows, rows);
};

/// How many rows of a set are equations; the rest have `lower` and `upper`.
template<ConstraintSet Set>
std::size_t bound_rows(const Set& set, std::vector<double>& lower, std::vector<double>& upper) {
  std::size_t equations = set.rows();
  if constexpr (OneSidedSet<Set>) equations = set.equations();
  lower.resize(set.rows() - equations);
  upper.resize(lower.size());
  if constexpr (OneSidedSet<Set>) set.program_bounds(lower, upper);
  return equations;
}

/// What Newton's method on the whole step asks of a set besides.
template<class S>
concept ConstraintSetInNewton = ConstraintSet<S> &&
    requires(S set, const S& fixed, std::span<double> rows, std::span<const double> z) {
  /// product = (J W J^T + a) z in the metric given last to `factor`. Collective.
  set.multiply(z, rows);
  /// C - a mu.
  fixed.residual(rows);
  /// 2 |mu|/l of local edges, in kg: what their tension adds to the stiffness of the step. What a push takes
  /// from it can make it indefinite; with its absolute value Newton's method buckles in steps that at most
  /// double, where without it (mu+) flat triangles under pins that come together were thrown apart.
  fixed.tension_weights(rows);
  /// mu.
  fixed.multipliers(rows);
  /// J, and where its rows are; for set-up.
  { fixed.row_edges() } -> std::same_as<std::vector<RowEdge>>;
  { fixed.row_places() } -> std::same_as<std::vector<RowPlace>>;
  { fixed.gradients() } -> std::convertible_to<std::span<const Vec3>>; ///< of local edges
};

} // namespace taut
