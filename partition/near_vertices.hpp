#pragma once
#include "partition/mesh_slab.hpp"

namespace taut {

/// Of each vertex of a slab the others that are near it.
struct NearVertices {
  std::vector<std::size_t> begin; ///< of slab vertex i: others[begin[i] .. begin[i+1])
  std::vector<Global> others;     ///< original numbers, ascending
};

/// Those nearer than `reach` (m, above 0) at `positions`, which are those of this rank's slab. No rank holds
/// more than its share, cut by cells of space. Collective; for set-up.
NearVertices find_near(MPI_Comm comm, const Slab& slab, std::span<const Vec3> positions, double reach);

} // namespace taut
