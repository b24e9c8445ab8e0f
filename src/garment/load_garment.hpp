#pragma once
#include "partition/mesh_slab.hpp"

#include <filesystem>

namespace taut::garment {

/// The garment of a pattern, meshed with edges about as long as `edge_length` (m) where the pattern says
/// nothing else; panels placed, not sewn. Rank 0 makes it, so it must fit into its memory. Collective; throws
/// `InputError`, the same on all ranks.
MeshSlab load_garment(MPI_Comm comm, const std::filesystem::path& pattern, double edge_length);

} // namespace taut::garment
