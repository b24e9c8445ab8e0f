#pragma once
// How Taut's preconditioners become PETSc's; for the .cpp files of this folder only.
#include "src/linear/petsc.hpp"

#include <petsc/private/pcimpl.h> // the way PETSc offers to add a preconditioner type

namespace taut {

/// What PETSc calls to make a preconditioner of these functions; they keep what they need in `pc->data`. To
/// PETSc it is its own transpose, which CG takes it to be.
template<PetscErrorCode (*set_up)(PC), PetscErrorCode (*apply)(PC, Vec, Vec), PetscErrorCode (*destroy)(PC)>
PetscErrorCode create_preconditioner(PC pc) {
  PetscFunctionBegin;
  pc->data = nullptr;
  pc->ops->setup = set_up;
  pc->ops->apply = apply;
  pc->ops->applytranspose = apply;
  pc->ops->destroy = destroy;
  PetscFunctionReturn(0);
}

} // namespace taut
