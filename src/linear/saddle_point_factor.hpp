#pragma once
#include "src/linear/filtered_operator.hpp"
#include "src/linear/row_edge.hpp"
#include "src/linear/solver_options.hpp"

#include <memory>

namespace taut {

/// The factor of the saddle-point system of Newton's method on the whole step,
///
///     [  H  -J^T ] [ x ]   [ r ]
///     [ -J  -a   ] [ m ] = [ c ],
///
/// by MUMPS (L D L^T), for any matrix H between vertices and any rows that are made of edges (RowEdge). Of
/// contacts, what couples vertices that are no neighbours is left out. Its PETSc prefix is `-kkt_`.
class SaddlePointFactor {
public:
  /// `entries` are all of J, of `rows` owned rows. All must outlive the factor. Collective.
  SaddlePointFactor(const DistributedMesh& mesh, const Pattern& pattern, std::span<const RowEdge> entries,
                    std::size_t rows);
  ~SaddlePointFactor();

  /// Takes the matrix, the gradients of local edges and a of owned rows, above 0 where they depend on each
  /// other. Collective.
  void factor(const FilteredOperator& stiffness, std::span<const Vec3> gradients,
              std::span<const double> compliance);

  /// Both vectors are three numbers for each owned vertex, then one for each owned row. Collective.
  SolveReport solve(std::span<const double> rhs, std::span<double> solution);

private:
  struct Matrix;
  std::unique_ptr<Matrix> matrix_;
};

} // namespace taut
