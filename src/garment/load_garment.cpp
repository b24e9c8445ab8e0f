#include "src/garment/load_garment.hpp"

#include "src/garment/garment_mesh.hpp"
#include "src/garment/read_pattern.hpp"

namespace taut::garment {

MeshSlab load_garment(MPI_Comm comm, const std::filesystem::path& file, double edge_length) {
  const SewingPattern pattern = read_pattern(comm, file);
  GarmentMesh mesh;
  on_rank_0(comm, [&] { mesh = mesh_garment(pattern, {edge_length, {}}); });
  return share_out(comm, mesh, file.string());
}

} // namespace taut::garment
