#pragma once
#include "src/state/cloth.hpp"

namespace taut {

/// The cloth of a case before it is shared out.
struct UndistributedCloth {
  MeshSlab slab;
  Topology topology; ///< without hinges where the case needs none
  config::Material material;
};

/// Reads or makes and checks the mesh. Throws InputError for one that cannot be simulated. Collective.
UndistributedCloth read_cloth(MPI_Comm comm, const Case& input);

/// The cloth of a case, on all ranks: read or made, checked, partitioned. Throws InputError for a mesh that
/// cannot be simulated. Collective.
Cloth load_cloth(MPI_Comm comm, const Case& input);

/// At rest, in the start shape. Collective.
State start_state(const Cloth& cloth, const Case& input);

} // namespace taut
