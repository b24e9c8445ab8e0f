#pragma once
#include "partition/mesh_slab.hpp"
#include "src/config/case.hpp"

#include <mpi.h>

namespace taut {

/// A mesh that every rank has all of.
struct WholeMesh {
  std::string name;
  std::vector<Vec3> positions; ///< m
  std::vector<Cell> cells;
};

/// The mesh of an obstacle, or all of its sequence, in metres with z up; not yet where `start` puts them.
/// Throws InputError for what is wrong with them. Collective.
std::vector<WholeMesh> meshes_of(MPI_Comm comm, const Case& input, int body);

} // namespace taut
