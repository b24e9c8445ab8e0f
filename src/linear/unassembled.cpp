#include "src/linear/unassembled.hpp"

#include "src/linear/preconditioner.hpp"

namespace taut {

namespace {

UnassembledMatrix::Parts& parts_of(Mat shell) {
  void* parts = nullptr;
  MatShellGetContext(shell, &parts);
  return *static_cast<UnassembledMatrix::Parts*>(parts);
}

PetscErrorCode multiply(Mat shell, Vec x, Vec y) {
  return on_arrays(x, y, [shell](std::span<const double> from, std::span<double> to) {
    parts_of(shell).filtered.apply(as_vectors(from), as_vectors(to));
  });
}

/// What PCPBJACOBI asks a matrix for.
PetscErrorCode invert_diagonal_blocks(Mat shell, const PetscScalar** values) {
  PetscFunctionBegin;
  UnassembledMatrix::Parts& parts = parts_of(shell);
  parts.diagonal_blocks.resize(parts.pattern.rows());
  parts.filtered.inverse_diagonal_blocks(parts.diagonal_blocks);
  static_assert(sizeof(Mat3) == 9 * sizeof(PetscScalar));
  *values = reinterpret_cast<const PetscScalar*>(parts.diagonal_blocks.data());
  PetscFunctionReturn(0);
}

/// What PCJACOBI asks a matrix for.
PetscErrorCode get_diagonal(Mat shell, Vec diagonal) {
  PetscFunctionBegin;
  UnassembledMatrix::Parts& parts = parts_of(shell);
  parts.diagonal_blocks.resize(parts.pattern.rows());
  parts.filtered.diagonal_blocks(parts.diagonal_blocks);
  PetscScalar* to = nullptr;
  PetscCall(VecGetArrayWrite(diagonal, &to));
  Vec3* out = reinterpret_cast<Vec3*>(to);
  for (const Mat3& block : parts.diagonal_blocks) *out++ = block.diagonal();
  PetscCall(VecRestoreArrayWrite(diagonal, &to));
  PetscFunctionReturn(0);
}

void renew(ScalarPreconditioner& of, const FilteredOperator& matrix) {
  of.factor(matrix.matrix(), matrix.freedom());
}
void renew(VertexMultigrid& of, const FilteredOperator& matrix) { of.set(matrix); }

/// PETSc's functions for a preconditioner of the matrix in this form.
template<class Of>
PetscErrorCode set_up_of(PC pc) {
  PetscFunctionBegin;
  PetscBool unassembled = PETSC_FALSE;
  const auto object = reinterpret_cast<PetscObject>(pc);
  PetscCall(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(pc->pmat), MATSHELL, &unassembled));
  PetscCheck(unassembled, PetscObjectComm(object), PETSC_ERR_ARG_WRONGSTATE,
             "pc_type %s works on the velocity matrix only", object->type_name);
  const UnassembledMatrix::Parts& parts = parts_of(pc->pmat);
  if (!pc->data) pc->data = new Of(parts.mesh, parts.pattern);
  renew(*static_cast<Of*>(pc->data), parts.filtered);
  PetscFunctionReturn(0);
}

template<class Of>
PetscErrorCode apply_of(PC pc, Vec b, Vec x) {
  return on_arrays(b, x, [pc](std::span<const double> from, std::span<double> to) {
    static_cast<Of*>(pc->data)->solve(as_vectors(from), as_vectors(to));
  });
}

template<class Of>
PetscErrorCode destroy_of(PC pc) {
  PetscFunctionBegin;
  delete static_cast<Of*>(pc->data);
  pc->data = nullptr;
  PetscFunctionReturn(0);
}

template<class Of>
void add_type(const char* name) {
  check(PCRegister(name, create_preconditioner<set_up_of<Of>, apply_of<Of>, destroy_of<Of>>));
}

} // namespace

UnassembledMatrix::UnassembledMatrix(const DistributedMesh& mesh, const Pattern& pattern)
    : parts_(std::make_unique<Parts>(Parts{mesh, FilteredOperator(mesh), pattern, {}})) {
  const PetscInt rows = 3 * mesh.vertices.owned;
  check(MatCreateShell(mesh.comm, rows, rows, PETSC_DETERMINE, PETSC_DETERMINE, parts_.get(),
                       shell_.address()));
  check(MatSetBlockSize(shell_, 3));
  check(MatSetOption(shell_, MAT_SPD, PETSC_TRUE));
  check(MatShellSetOperation(shell_, MATOP_MULT, reinterpret_cast<void (*)()>(multiply)));
  check(MatShellSetOperation(shell_, MATOP_INVERT_BLOCK_DIAGONAL,
                             reinterpret_cast<void (*)()>(invert_diagonal_blocks)));
  check(MatShellSetOperation(shell_, MATOP_GET_DIAGONAL, reinterpret_cast<void (*)()>(get_diagonal)));
}

void UnassembledMatrix::set(const VertexMatrix& matrix, const Freedom& freedom) {
  parts_->filtered.set(matrix, freedom);
  mark_changed(shell_);
}

void register_velocity_preconditioners() {
  add_type<ScalarPreconditioner>("axis");
  add_type<VertexMultigrid>("grids");
}

} // namespace taut
