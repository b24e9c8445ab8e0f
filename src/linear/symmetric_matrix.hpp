#pragma once
// For the .cpp files of this folder only.
#include "partition/comm.hpp"
#include "src/linear/petsc.hpp"

#include <limits>
#include <vector>

namespace taut {

/// Places of entries, in the order in which MatSetValuesCOO takes their values; what has the same place adds
/// up.
struct EntryPlaces {
  std::vector<PetscInt> rows, columns;

  void add(PetscInt row, PetscInt column) {
    rows.push_back(row);
    columns.push_back(column);
  }
};

/// Throws where PETSc cannot number so many unknowns of all ranks together. Collective.
inline void check_unknowns(MPI_Comm comm, Global of_this_rank) {
  if (sum_over(comm, of_this_rank) > std::numeric_limits<PetscInt>::max())
    throw std::runtime_error(
        "the mesh has more unknowns than this PETSc can number: use one with 64-bit indices");
}

/// A symmetric matrix with the options' prefix `prefix`, of which this rank has so many rows. Collective.
inline OwnedMat make_symmetric_matrix(MPI_Comm comm, const char* prefix, PetscInt rows, EntryPlaces places) {
  OwnedMat matrix;
  check(MatCreate(comm, matrix.address()));
  check(MatSetOptionsPrefix(matrix, prefix));
  check(MatSetSizes(matrix, rows, rows, PETSC_DETERMINE, PETSC_DETERMINE));
  check(MatSetType(matrix, MATAIJ));
  check(MatSetPreallocationCOO(matrix, PetscCount(places.rows.size()), places.rows.data(),
                               places.columns.data()));
  check(MatSetOption(matrix, MAT_SYMMETRIC, PETSC_TRUE));
  check(MatSetOption(matrix, MAT_SYMMETRY_ETERNAL, PETSC_TRUE));
  return matrix;
}

} // namespace taut
