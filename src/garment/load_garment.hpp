#pragma once
#include "partition/mesh_slab.hpp"
#include "src/config/case.hpp"
#include "src/garment/garment_mesh.hpp"
#include "src/garment/sewing_pattern.hpp"

namespace taut::garment {

/// The garment of a pattern, on rank 0; empty on the others.
struct Garment {
  std::string name; ///< how messages call it: the file
  GarmentMesh mesh;
};

/// The pattern of cloth `k` of a case, meshed with edges about as long as that says; panels placed, not sewn.
/// Rank 0 makes it, so it must fit into its memory. Collective; throws `InputError`, the same on all ranks.
Garment load_garment(MPI_Comm comm, const Case& input, std::size_t k);

/// Its mesh in slabs; with `joint` (MeshSlab) if that is asked for. Collective.
enum class Joints { none, of_seams };
MeshSlab share_out(MPI_Comm comm, const Garment& garment, Joints joints);

} // namespace taut::garment
