#pragma once
#include "src/linear/condensed_factor.hpp"
#include "src/linear/gcr.hpp"
#include "src/newton/coarse_system.hpp"
#include "src/state/cloth.hpp"

namespace taut {

/// Solves the saddle-point system of Newton's method on the whole step,
///
///     [ H  J^T ] [ dx  ]     [ r ]
///     [ J  -a  ] [ dmu ] = - [ c ],
///
/// with the stiffness H of the step, that of tension included, and a set of constraints; by the generalised
/// conjugate residual method (Gcr). It is preconditioned by the system's factor (`mumps`, CondensedFactor),
/// which is nearly exact but where contacts press, or (`cg`) by what
///
/// 1. solves the system on a coarse grid (CoarseSystem): displacements and tensions that reach far;
/// 2. takes what is left for displacements through the finer grids (VertexMultigrid) with the tensions found;
/// 3. moves vertices to where the constraints are met, in the metric of the diagonal of H, as a projection
///    does: (J W J^T + a) z = c + J dx, dx -= W J^T z, with W_i = 3/trace H_ii;
/// 4. chooses the tensions that leave the least of the equations of motion, in the same metric.
///
/// 3 and 4 ask for the same approximate inverse of J W J^T + a, by a few conjugate gradients with that of the
/// set (exact along yarns). With 3 alone, of which the z are tensions too, GCR stops: in the metric of the
/// diagonal they are too large by far where H is stiff.
template<ConstraintSetInNewton Set>
class NewtonSolver {
public:
  /// All must outlive the solver. Collective.
  NewtonSolver(const Cloth& cloth, const Pattern& pattern, Set& set, SolverOptions::Kind kind);

  /// What of the equations may be left, or is.
  struct Goal {
    double least, most; ///< m: by which it would move the cloth (see `movement`); between these, a thousandth
                        ///< of how far the cloth comes in the step
    std::span<const Vec3> moved; ///< m, owned vertices: how far it has come before the solve
    double strain;               ///< the part of the strain limit that the linearised constraints may miss
  };

  /// Forgets what earlier steps left: the next matrix is factored anew.
  void begin_step() {
    age_ = Age::none;
    may_keep_factor_ = true;
  }

  /// Takes the matrix and the set as it was evaluated last. (A factor stays, within a step, until a solve
  /// would take many iterations with it; from then on each matrix is factored.) Collective.
  void factor(const FilteredOperator& stiffness);

  /// `r` over owned vertices, in kg m; `c` over owned rows, as the set's residual. `dx` (local, ghosts
  /// current) and `dmu` (owned rows) are the solution, as far as it was found within `max_iterations` and as
  /// long as there was progress: neither is a failure, that of the factor is. Takes one iteration or more.
  /// Collective.
  SolveReport solve(std::span<const Vec3> r, std::span<const double> c, const Goal& goal, int max_iterations,
                    std::vector<Vec3>& dx, std::vector<double>& dmu);

  /// How far what is left of the equations of motion, `r` as in `solve`, would move the cloth, root mean
  /// square in m: by the factor, or H^-1 r by a cycle of the grids, as they were made last. (All of the
  /// preconditioner gives 0.6 to 1.5 times as much as the cycle, and costs four times as much.) Collective.
  double movement(std::span<const Vec3> r);

  /// Root mean square over the masses, of owned vertices. Collective.
  double rms(std::span<const Vec3> field) const;

private:
  double allowed_movement(const Goal& goal);
  double strain(std::span<const double> c) const;
  void find_metric();
  void renew_factor();
  bool serves(const SolveReport& report, double movement, double allowed);
  std::string find_direction();
  void precondition();
  void begin_product();
  void end_product();
  void solve_rows();
  double dot(std::span<const double> a, std::span<const double> b) const;
  void project(std::span<Vec3> x);
  void choose_multipliers();
  void spread(std::span<const double> z);

  const Cloth& cloth_;
  Set& set_;
  std::vector<RowEdge> row_edges_;
  std::optional<VertexMultigrid> grids_; ///< these two,
  std::optional<CoarseSystem> coarse_;
  std::optional<CondensedFactor> factor_; ///< or this, of the system for (dx, -dmu)
  Gcr gcr_;
  enum class Age {
    none,
    old,
    current
  } age_ = Age::none;           ///< of the factor: old if of another matrix of this step
  bool may_keep_factor_ = true; ///< in this step: those of other matrices have served
  double first_movement_ = 0;   ///< of a solve, m
  const FilteredOperator* stiffness_ = nullptr;
  double total_mass_;
  // Unknowns are (dx, -dmu), because sets subtract what they multiply; first three for each owned vertex,
  // then the rows.
  std::vector<double> solution_, left_, source_, direction_, product_, weights_;
  std::vector<double> metric_;              ///< W, of local vertices
  std::vector<double> yielding_;            ///< a of owned rows, as in the factor
  std::vector<double> tolerance_, rows_;    ///< of owned rows; rows_: room
  std::array<std::vector<double>, 4> room_; ///< of owned rows, for conjugate gradients
  std::vector<Vec3> x_, y_, nodes_, start_; ///< room: local vertices, nodes of the coarse grid
};

} // namespace taut
