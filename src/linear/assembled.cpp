#include "src/linear/assembled.hpp"

#include <algorithm>

namespace taut {

namespace {

struct BlockCounts {
  std::vector<PetscInt> own, ghost, own_upper, ghost_upper;
};

BlockCounts count_blocks(const DistributedMesh& mesh, const Pattern& pattern) {
  const Local rows = pattern.rows();
  BlockCounts n{std::vector<PetscInt>(rows, 0), std::vector<PetscInt>(rows, 0),
                std::vector<PetscInt>(rows, 0), std::vector<PetscInt>(rows, 0)};
  for (Local row = 0; row < rows; ++row)
    for (const Local column : pattern.columns(row)) {
      const bool own = mesh.owns_vertex(column),
                 upper = mesh.vertices.global(column) >= mesh.vertices.global(row);
      ++(own ? n.own : n.ghost)[row];
      if (upper) ++(own ? n.own_upper : n.ghost_upper)[row];
    }
  return n;
}

void set_local_numbers(Mat matrix, const DistributedMesh& mesh) {
  std::vector<PetscInt> global(mesh.vertices.size());
  for (Local i = 0; i < mesh.vertices.size(); ++i) global[i] = PetscInt(mesh.vertices.global(i));
  ISLocalToGlobalMapping map = nullptr;
  check(ISLocalToGlobalMappingCreate(mesh.comm, 3, PetscInt(global.size()), global.data(), PETSC_COPY_VALUES,
                                     &map));
  check(MatSetLocalToGlobalMapping(matrix, map, map));
  check(ISLocalToGlobalMappingDestroy(&map));
}

} // namespace

AssembledMatrix::AssembledMatrix(const DistributedMesh& mesh, const Pattern& pattern)
    : pattern_(pattern), blocks_(pattern.entries()) {
  const PetscInt rows = 3 * mesh.vertices.owned;
  check(MatCreate(mesh.comm, matrix_.address()));
  check(MatSetOptionsPrefix(matrix_, "velocity_"));
  check(MatSetSizes(matrix_, rows, rows, PETSC_DETERMINE, PETSC_DETERMINE));
  check(MatSetBlockSize(matrix_, 3));
  check(MatSetType(matrix_, MATAIJ));
  check(MatSetFromOptions(matrix_));
  const BlockCounts n = count_blocks(mesh, pattern);
  check(MatXAIJSetPreallocation(matrix_, 3, n.own.data(), n.ghost.data(), n.own_upper.data(),
                                n.ghost_upper.data()));
  set_local_numbers(matrix_, mesh);
  check(MatSetOption(matrix_, MAT_NO_OFF_PROC_ENTRIES, PETSC_TRUE));
  PetscBool symmetric_storage = PETSC_FALSE, blocked = PETSC_FALSE;
  check(PetscObjectTypeCompareAny(reinterpret_cast<PetscObject>(Mat(matrix_)), &symmetric_storage,
                                  MATSEQSBAIJ, MATMPISBAIJ, ""));
  if (symmetric_storage) check(MatSetOption(matrix_, MAT_IGNORE_LOWER_TRIANGULAR, PETSC_TRUE));
  check(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(Mat(matrix_)), MATMPIBAIJ, &blocked));
  if (!blocked) check(MatSetOption(matrix_, MAT_SPD, PETSC_TRUE)); // parallel BAIJ refuses it
}

void AssembledMatrix::assemble(const FilteredOperator& filtered) {
  filtered.blocks(blocks_);
  std::vector<PetscScalar> values; // one block row, three rows of numbers
  for (Local row = 0; row < pattern_.rows(); ++row) {
    const auto columns = pattern_.columns(row);
    const Mat3* block = blocks_.data() + pattern_.offset(row);
    values.resize(9 * columns.size());
    for (std::size_t c = 0; c < columns.size(); ++c)
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) values[i * 3 * columns.size() + 3 * c + j] = block[c](i, j);
    check(MatSetValuesBlockedLocal(matrix_, 1, &row, PetscInt(columns.size()), columns.data(), values.data(),
                                   INSERT_VALUES));
  }
  check(MatAssemblyBegin(matrix_, MAT_FINAL_ASSEMBLY));
  check(MatAssemblyEnd(matrix_, MAT_FINAL_ASSEMBLY));
}

} // namespace taut
