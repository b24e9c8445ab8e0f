#include "src/garment/load_garment.hpp"

#include "io/scatter.hpp"
#include "src/garment/place_panels.hpp"
#include "src/garment/read_pattern.hpp"
#include "src/garment/sewn_mesh.hpp"

namespace taut::garment {

Garment load_garment(MPI_Comm comm, const Case& input, std::size_t k) {
  const config::Cloth& cloth = input.cloths[k];
  const auto file = input.folder() / *cloth.pattern;
  EdgeLengths lengths{*cloth.edge, {}};
  for (const auto& [name, panel] : cloth.panels)
    if (panel.edge) lengths.panels[name] = *panel.edge;
  constexpr double apart = 0.5; // edges
  const SewingPattern pattern = read_pattern(comm, file);
  Garment garment{file.string(), {}};
  on_rank_0(comm, [&] {
    garment.mesh =
        mesh_garment(input.sewing ? place_panels(pattern, apart * lengths.garment) : pattern, lengths);
  });
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
