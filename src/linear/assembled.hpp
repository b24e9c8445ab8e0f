#pragma once
#include "src/linear/filtered_operator.hpp"
#include "src/linear/petsc.hpp"

#include <memory>

namespace taut {

/// The filtered velocity matrix as a PETSc matrix of 3 x 3 blocks, for MUMPS and for preconditioners that
/// look at entries. Its type is AIJ or what `-velocity_mat_type` says (baij, sbaij).
class AssembledMatrix {
public:
  AssembledMatrix(const DistributedMesh& mesh, const Pattern& pattern);

  /// Fills in the values; every rank its own rows. Collective.
  void assemble(const FilteredOperator& filtered);

  operator Mat() const { return matrix_; }

private:
  const Pattern& pattern_;
  std::vector<Mat3> blocks_; ///< in the pattern's order
  OwnedMat matrix_;
};

} // namespace taut
