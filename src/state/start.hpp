#pragma once
#include "partition/join.hpp"
#include "src/state/state.hpp"

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

/// The cloths of a case, on all ranks: read or made, checked, partitioned. Throws InputError for a mesh that
/// cannot be simulated. Collective.
Cloth load_cloth(MPI_Comm comm, const Case& input);

/// At rest, in the start shape. Throws InputError for a cloth too far away to be computed. Collective.
State start_state(const Cloth& cloth, const Case& input);

} // namespace taut
