#include "src/linear/yarn_preconditioner.hpp"

#include "src/linear/preconditioner.hpp"

namespace taut {

namespace {

constexpr const char* key = "taut_yarn_blocks";

PetscErrorCode set_up(PC pc) {
  PetscFunctionBegin;
  PetscObject container = nullptr;
  PetscCall(PetscObjectQuery(reinterpret_cast<PetscObject>(pc->pmat), key, &container));
  PetscCheck(container, PetscObjectComm(reinterpret_cast<PetscObject>(pc)), PETSC_ERR_ARG_WRONGSTATE,
             "pc_type yarn works on the projection matrix only");
  PetscCall(PetscContainerGetPointer(reinterpret_cast<PetscContainer>(container), &pc->data));
  auto* blocks = static_cast<YarnBlocks*>(pc->data);
  blocks->factor.factor(blocks->matrix);
  PetscFunctionReturn(0);
}

PetscErrorCode apply(PC pc, Vec b, Vec x) {
  return on_arrays(b, x, [pc](std::span<const double> from, std::span<double> to) {
    const auto& blocks = *static_cast<const YarnBlocks*>(pc->data);
    blocks.factor.solve(from, to);
    for (std::size_t e = 0; e < blocks.added_to_inverse.size(); ++e)
      to[e] += blocks.added_to_inverse[e] * from[e];
  });
}

/// The blocks are the matrix's; there is nothing to free.
PetscErrorCode destroy(PC pc) {
  PetscFunctionBegin;
  pc->data = nullptr;
  PetscFunctionReturn(0);
}

} // namespace

void register_yarn_preconditioner() {
  check(PCRegister("yarn", create_preconditioner<set_up, apply, destroy>));
}

void attach(Mat matrix, YarnBlocks& blocks) {
  PetscContainer container = nullptr;
  check(PetscContainerCreate(PetscObjectComm(reinterpret_cast<PetscObject>(matrix)), &container));
  check(PetscContainerSetPointer(container, &blocks));
  check(PetscObjectCompose(reinterpret_cast<PetscObject>(matrix), key,
                           reinterpret_cast<PetscObject>(container)));
  check(PetscContainerDestroy(&container));
}

} // namespace taut
