#pragma once
#include "partition/mesh_slab.hpp"
#include "src/garment/garment_mesh.hpp"
#include "src/garment/sewing_pattern.hpp"

#include <filesystem>

namespace taut::garment {

/// The garment of a pattern, on rank 0; empty on the others.
struct Garment {
  std::string name; ///< how messages call it: the file
  GarmentMesh mesh;
};

/// Meshed with edges about as long as `edge_length` (m) where the pattern says nothing else; panels placed,
/// not sewn. Rank 0 makes it, so it must fit into its memory. Collective; throws `InputError`, the same on
/// all ranks.
Garment load_garment(MPI_Comm comm, const std::filesystem::path& pattern, double edge_length);

/// Its mesh in slabs; with `joint` (MeshSlab) if that is asked for. Collective.
enum class Joints { none, of_seams };
MeshSlab share_out(MPI_Comm comm, const Garment& garment, Joints joints);

} // namespace taut::garment
