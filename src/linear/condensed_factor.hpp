#pragma once
#include "src/linear/filtered_operator.hpp"
#include "src/linear/row_edge.hpp"
#include "src/linear/solver_options.hpp"

#include <memory>

namespace taut {

/// The factor of what the saddle-point system of Newton's method on the whole step,
///
///     [  H  -J^T ] [ x ]   [ r ]
///     [ -J  -a   ] [ m ] = [ c ],
///
/// comes to without its multipliers m = -a^-1 (c + J x),
///
///     (H + J^T a^-1 J) x = r - J^T a^-1 c,
///
/// by MUMPS (L D L^T), for any matrix H between vertices and any rows that are made of edges (RowEdge). It
/// has three unknowns for each vertex, in blocks, and where a is small a large condition number: what
/// roundoff leaves is for an iteration around it. Of contacts, what couples vertices that are no neighbours
/// is left out. Its PETSc prefix is `-kkt_`.
class CondensedFactor {
public:
  /// `entries` are all of J, of `rows` owned rows. All must outlive the factor. Collective.
  CondensedFactor(const DistributedMesh& mesh, const Pattern& pattern, std::span<const RowEdge> entries,
                  std::size_t rows);
  ~CondensedFactor();

  /// Takes the matrix, the gradients of local edges and a of owned rows, above 0. Collective.
  void factor(const FilteredOperator& stiffness, std::span<const Vec3> gradients,
              std::span<const double> compliance);

  /// Both vectors are three numbers for each owned vertex, then one for each owned row. Collective.
  SolveReport solve(std::span<const double> rhs, std::span<double> solution);

private:
  struct Matrix;
  std::unique_ptr<Matrix> matrix_;
};

} // namespace taut
