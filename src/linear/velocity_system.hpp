#pragma once
#include "src/linear/solver_options.hpp"
#include "src/linear/vertex_matrix.hpp"
#include "src/state/freedom.hpp"

#include <memory>

namespace taut {

/// Solves A v = b for the velocities of a step [BW98 eq. 6], with some of them prescribed [BW98 section 5;
/// the projected form of Ascher and Boxerman 2003, for which a preconditioner sees the filtered matrix].
///
/// With Constraints::filtered the modified CG of the paper solves it instead, and PETSc options mean nothing.
///
/// PETSc prefix `-velocity_`. With CG and the preconditioners `axis`, `pbjacobi`, `jacobi` and `none`, and
/// with GMRES and `grids`, the matrix is applied as it is; for every other preconditioner, and for MUMPS, it
/// is assembled as a PETSc matrix of 3 x 3 blocks (`-velocity_mat_type aij`, `baij`, `sbaij`).
class VelocitySystem {
public:
  /// `mesh` and `pattern` must outlive the system.
  /// `name` gives the prefix of another solver of such systems. Collective.
  VelocitySystem(const DistributedMesh& mesh, const Pattern& pattern, const SolverOptions& options,
                 const char* name = "velocity");
  ~VelocitySystem();

  /// On entry `v` (local vertices, ghosts current) holds the velocity at the start of the step and, in the
  /// directions that `freedom` denies, what is prescribed there; on exit the solution, ghosts current. `rhs`
  /// over owned vertices. The residual falls by the factor `tolerance` from that of the entry. Collective.
  SolveReport solve(const VertexMatrix& matrix, std::span<const Vec3> rhs, const Freedom& freedom,
                    double tolerance, std::vector<Vec3>& v);

private:
  struct Petsc;
  const DistributedMesh& mesh_;
  SolverOptions options_;
  std::unique_ptr<Petsc> petsc_;
};

} // namespace taut
