#pragma once
#include "src/linear/sparse_rows.hpp"

#include <vector>

namespace taut {

/// The incomplete Cholesky factorisation without fill, L D L^T, of a symmetric scalar matrix within a rank,
/// applied to vectors in space, their three axes in one sweep. Couplings to ghosts are left out.
class IncompleteCholesky {
public:
  explicit IncompleteCholesky(const SparseRows& rows);

  /// `values` in the order of the rows. A fifth of every positive coupling is added to the diagonal of both
  /// its ends. Of a diagonally dominant matrix without positive couplings a factor without fill always exists
  /// [Meijerink, van der Vorst 1977]; those of bending are what makes pivots vanish, and what makes up for
  /// them must weigh as much as they do: as a part of the whole diagonal it would outweigh the inertia of a
  /// taut thread. If a pivot still comes out too small, the factorisation starts again with a larger diagonal
  /// [Manteuffel 1980], by the factor 1.1 and more. A matrix that is not positive definite is for the solver
  /// to find out: entries of the diagonal below 0 are made positive. Depends on nothing but its arguments, so
  /// that a resumed run goes on exactly as the unbroken one. Not collective.
  void factor(const SparseRows& rows, std::span<const double> values);

  /// x = (L D L^T)^-1 b over owned points. Not collective.
  void solve(std::span<const Vec3> b, std::span<Vec3> x) const;

private:
  void collect(const SparseRows& rows, std::span<const double> values);
  bool eliminate();

  std::vector<std::int32_t> offsets_{0}; ///< rows of the strictly lower triangle
  std::vector<Local> columns_;
  std::vector<float> lower_;     ///< of L; in single precision, as a solve does little but read it
  std::vector<double> diagonal_; ///< D; in `factor`, first that of the matrix, enlarged
};

} // namespace taut
