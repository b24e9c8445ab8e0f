#pragma once
#include "src/linear/kkt_system.hpp"
#include "src/linear/krylov.hpp"

namespace taut {

/// KktSystem as one assembled matrix. A rank owns the rows of its vertices, three each, then those of its
/// edges.
struct KktSystem::Direct {
  Direct(const DistributedMesh& mesh, const SolverOptions& options);

  void assemble(const Terms& terms);
  SolveReport solve(std::span<const Vec3> f, std::span<const double> c, double tolerance,
                    std::vector<Vec3>& dx, std::vector<double>& dmu);

private:
  void fix_pattern(PetscInt rows);

  const DistributedMesh& mesh_;
  std::vector<PetscInt> vertex_row_, edge_row_; ///< first row of local vertices, row of local edges
  OwnedMat matrix_;
  OwnedVec rhs_, solution_;
  LinearSolver solver_;
  std::vector<PetscScalar> values_; ///< in the order of `visit_entries`
  Terms terms_{};
};

} // namespace taut
