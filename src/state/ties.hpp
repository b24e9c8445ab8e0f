#pragma once
#include "src/state/start.hpp"

namespace taut {

/// Fills `ties` of a cloth that is not shared out yet: what the attachments of the case fasten to each other.
/// Throws InputError for labels and vertices that are not there. Collective.
void find_ties(MPI_Comm comm, const Case& input, UndistributedCloth& cloth);

} // namespace taut
