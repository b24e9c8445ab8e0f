#pragma once
#include "src/linear/filtered_operator.hpp"
#include "src/linear/petsc.hpp"
#include "src/linear/scalar_preconditioner.hpp"
#include "src/linear/vertex_multigrid.hpp"

#include <memory>

namespace taut {

/// The filtered velocity matrix as PETSc sees it when it is not assembled: it can be multiplied with, and it
/// supports the preconditioners `axis` (ScalarPreconditioner), `grids` (VertexMultigrid), `pbjacobi` and
/// `jacobi`.
class UnassembledMatrix {
public:
  /// Collective.
  UnassembledMatrix(const DistributedMesh& mesh, const Pattern& pattern);

  /// From now on this matrix, with these directions left out; both must outlive the next solve. Not
  /// collective.
  void set(const VertexMatrix& matrix, const Freedom& freedom);

  const FilteredOperator& filtered() const { return parts_->filtered; }
  operator Mat() const { return shell_; }

  /// What PETSc's callbacks reach through the matrix.
  struct Parts {
    const DistributedMesh& mesh;
    FilteredOperator filtered;
    const Pattern& pattern;
    std::vector<Mat3> diagonal_blocks; ///< made when a preconditioner asks for them
  };

private:
  std::unique_ptr<Parts> parts_;
  OwnedMat shell_;
};

/// Makes `-velocity_pc_type axis` and `grids` known to PETSc. Once a program.
void register_velocity_preconditioners();

/// PETSc's numbers as vectors in space.
inline std::span<Vec3> as_vectors(std::span<double> values) {
  static_assert(sizeof(Vec3) == 3 * sizeof(double));
  return {reinterpret_cast<Vec3*>(values.data()), values.size() / 3};
}
inline std::span<const Vec3> as_vectors(std::span<const double> values) {
  return {reinterpret_cast<const Vec3*>(values.data()), values.size() / 3};
}

} // namespace taut
