#include "src/garment/load_garment.hpp"

#include "io/scatter.hpp"
#include "src/garment/read_pattern.hpp"
#include "src/garment/sewn_mesh.hpp"

namespace taut::garment {

Garment load_garment(MPI_Comm comm, const std::filesystem::path& file, double edge_length) {
  const SewingPattern pattern = read_pattern(comm, file);
  Garment garment{file.string(), {}};
  on_rank_0(comm, [&] { garment.mesh = mesh_garment(pattern, {edge_length, {}}); });
  return garment;
}

MeshSlab share_out(MPI_Comm comm, const Garment& garment, Joints joints) {
  MeshSlab slab = share_out(comm, garment.mesh, garment.name);
  if (joints == Joints::of_seams)
    slab.joint = scatter_slabs(comm, rank_of(comm) == 0 ? joints_of(garment.mesh) : std::vector<Global>(),
                               slab.vertices);
  return slab;
}

} // namespace taut::garment
