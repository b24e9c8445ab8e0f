#pragma once
#include "partition/join.hpp"
#include "src/state/state.hpp"

#include <functional>

namespace taut {

/// The cloths of a case before it is shared out.
struct UndistributedCloth {
  ListedMesh mesh; ///< without hinges where the case needs none
  std::vector<Piece> pieces;
  std::vector<Tie> ties;
};

/// Reads or makes, checks and joins the meshes. Throws InputError for one that cannot be simulated.
/// Collective.
UndistributedCloth read_cloth(MPI_Comm comm, const Case& input);

/// Where the vertices of this rank's slab are, m. Collective.
using Places = std::function<std::vector<Vec3>()>;

/// The part, of `parts`, that each vertex of this rank's slab belongs to, cut as the case says. Cloth that
/// can collide is cut by what is near each other too; only then `places` are asked for. Collective.
std::vector<int> cut_by_places(MPI_Comm comm, const UndistributedCloth& cloth, const Case& input,
                               const Places& places, int parts);

/// At the start. All must outlive it.
Places places_at_start(MPI_Comm comm, const UndistributedCloth& cloth, const Case& input);

/// The rank that each vertex of this rank's slab is given to. Collective.
using Cut = std::function<std::vector<int>(MPI_Comm, const UndistributedCloth&, const Case&)>;

/// By what is near each other at the start.
std::vector<int> cut_at_start(MPI_Comm comm, const UndistributedCloth& cloth, const Case& input);

/// The cloths of a case, on all ranks: read or made, checked, partitioned. Throws InputError for a mesh that
/// cannot be simulated. Collective.
Cloth load_cloth(MPI_Comm comm, const Case& input, const Cut& cut = cut_at_start);

/// At rest, in the start shape. Throws InputError for a cloth too far away to be computed. Collective.
State start_state(const Cloth& cloth, const Case& input);

} // namespace taut
