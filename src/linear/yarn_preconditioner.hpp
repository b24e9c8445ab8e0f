#pragma once
#include "src/linear/petsc.hpp"
#include "src/linear/yarn_factor.hpp"

namespace taut {

/// Makes `-projection_pc_type yarn` known to PETSc. Once a program.
void register_yarn_preconditioner();

/// What the preconditioner of a matrix works on.
struct YarnBlocks {
  YarnTridiagonal matrix; ///< current values
  YarnFactor factor;
  std::span<const double> added_to_inverse; ///< to its diagonal, of owned edges; empty: nothing
};

/// Lets the preconditioner `yarn` find the blocks of `matrix`, which must outlive it.
void attach(Mat matrix, YarnBlocks& blocks);

} // namespace taut
