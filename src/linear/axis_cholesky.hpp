#pragma once
#include "src/linear/vertex_matrix.hpp"
#include "src/state/freedom.hpp"

namespace taut {

/// A preconditioner for A = B (x) I_3 + sum g g^T that treats the three axes alike: the incomplete Cholesky
/// factorisation without fill, L D L^T, of the scalar matrix B + 1/3 sum <g, g^T>, whose entries are the
/// means over the axes of those of A. Within a rank; couplings to ghosts are left out. A factor takes a
/// twenty-seventh of the work that the 3 x 3 blocks would, and is applied to the three axes in one sweep.
class AxisCholesky {
public:
  /// `pattern` must outlive the factor.
  explicit AxisCholesky(const Pattern& pattern);

  /// Held vertices get the identity; those that may move in some directions count as free. If a pivot comes
  /// out too small, it starts again with a larger diagonal [Manteuffel 1980]. A matrix that is not positive
  /// definite is for the solver to find out: entries of the diagonal below 0 are made positive. Depends on
  /// nothing but its arguments, so that a resumed run goes on exactly as the unbroken one. Not collective.
  void factor(const VertexMatrix& matrix, const Freedom& freedom);

  /// x = (L D L^T)^-1 b over owned vertices. Not collective.
  void solve(std::span<const Vec3> b, std::span<Vec3> x) const;

private:
  void collect(const VertexMatrix& matrix);
  bool eliminate();
  void leave_out(const Freedom& freedom);
  double* entry(Local row, Local column);

  const Pattern& pattern_;
  std::vector<std::int32_t> offsets_{0}; ///< rows of the strictly lower triangle
  std::vector<Local> columns_;
  std::vector<double> lower_;
  std::vector<double> diagonal_; ///< D; in `factor`, first the matrix's own diagonal
};

} // namespace taut
