#pragma once
#include <string>

namespace taut {

/// How a linear system is to be solved. PETSc options with the system's prefix change everything else.
struct SolverOptions {
  enum class Kind {
    cg,    ///< preconditioned conjugate gradients; GMRES where the matrix is not symmetric
    mumps, ///< distributed factorisation: Cholesky, L D L^T or L U
  };
  enum class Matrix { positive_definite, indefinite, nonsymmetric };
  /// With `cg`, of velocities.
  enum class Preconditioner {
    axis, ///< ScalarPreconditioner
    grids ///< VertexMultigrid, which is not symmetric: with GMRES in place of CG
  };
  /// How velocities that are prescribed are kept, where there are any.
  enum class Constraints {
    projected, ///< the matrix is restricted to the free directions [Ascher and Boxerman 2003]
    filtered   ///< each vector of CG is [BW98 section 5.2]
  };

  Kind kind = Kind::cg;
  int max_iterations = 1000;
  Matrix matrix = Matrix::positive_definite;
  Preconditioner preconditioner = Preconditioner::axis;
  Constraints constraints = Constraints::projected;
};

struct SolveReport {
  int iterations = 0;
  std::string failure; ///< empty if the solver reached its tolerance; else PETSc's reason
};

} // namespace taut
