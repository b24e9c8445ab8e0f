#include "src/linear/yarn_preconditioner.hpp"

#include "src/linear/petsc.hpp"

#include <petsc/private/pcimpl.h> // the way PETSc offers to add a preconditioner type

namespace taut {

void YarnFactor::factor(const YarnTridiagonal& matrix) {
  const std::size_t n = matrix.diagonal.size();
  lower_.resize(n);
  inverse_diagonal_.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    const double coupling = matrix.to_previous[i];
    lower_[i] = i == 0 ? 0.0 : coupling * inverse_diagonal_[i - 1];
    inverse_diagonal_[i] = 1.0 / (matrix.diagonal[i] - lower_[i] * coupling);
  }
}

void YarnFactor::solve(std::span<const double> b, std::span<double> x) const {
  const std::size_t n = lower_.size();
  double carried = 0;
  for (std::size_t i = 0; i < n; ++i) x[i] = carried = b[i] - lower_[i] * carried;
  double after = 0;
  for (std::size_t i = n; i-- > 0;) {
    x[i] = x[i] * inverse_diagonal_[i] - after;
    after = lower_[i] * x[i];
  }
}

namespace {

constexpr const char* key = "taut_yarn_tridiagonal";

YarnFactor& factor_of(PC pc) { return *static_cast<YarnFactor*>(pc->data); }

PetscErrorCode set_up(PC pc) {
  PetscFunctionBegin;
  PetscObject container = nullptr;
  PetscCall(PetscObjectQuery(reinterpret_cast<PetscObject>(pc->pmat), key, &container));
  PetscCheck(container, PetscObjectComm(reinterpret_cast<PetscObject>(pc)), PETSC_ERR_ARG_WRONGSTATE,
             "pc_type yarn works on the projection matrix only");
  void* matrix = nullptr;
  PetscCall(PetscContainerGetPointer(reinterpret_cast<PetscContainer>(container), &matrix));
  factor_of(pc).factor(*static_cast<const YarnTridiagonal*>(matrix));
  PetscFunctionReturn(0);
}

PetscErrorCode apply(PC pc, Vec b, Vec x) {
  PetscFunctionBegin;
  PetscInt n = 0;
  const PetscScalar* from = nullptr;
  PetscScalar* to = nullptr;
  PetscCall(VecGetLocalSize(b, &n));
  PetscCall(VecGetArrayRead(b, &from));
  PetscCall(VecGetArrayWrite(x, &to));
  factor_of(pc).solve({from, std::size_t(n)}, {to, std::size_t(n)});
  PetscCall(VecRestoreArrayWrite(x, &to));
  PetscCall(VecRestoreArrayRead(b, &from));
  PetscFunctionReturn(0);
}

PetscErrorCode destroy(PC pc) {
  PetscFunctionBegin;
  delete static_cast<YarnFactor*>(pc->data);
  pc->data = nullptr;
  PetscFunctionReturn(0);
}

PetscErrorCode create(PC pc) {
  PetscFunctionBegin;
  pc->data = new YarnFactor;
  pc->ops->setup = set_up;
  pc->ops->apply = apply;
  pc->ops->applytranspose = apply;
  pc->ops->destroy = destroy;
  PetscFunctionReturn(0);
}

} // namespace

void register_yarn_preconditioner() { check(PCRegister("yarn", create)); }

void attach(Mat matrix, YarnTridiagonal* yarns) {
  PetscContainer container = nullptr;
  check(PetscContainerCreate(PetscObjectComm(reinterpret_cast<PetscObject>(matrix)), &container));
  check(PetscContainerSetPointer(container, yarns));
  check(PetscObjectCompose(reinterpret_cast<PetscObject>(matrix), key, reinterpret_cast<PetscObject>(container)));
  check(PetscContainerDestroy(&container));
}

} // namespace taut
