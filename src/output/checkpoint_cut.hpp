#pragma once
#include "io/hdf5.hpp"
#include "src/state/start.hpp"

#include <filesystem>

/// How the cloth of a run is cut for the ranks, in its checkpoints.
namespace taut {

/// Puts down which rank owns each vertex. Collective.
void write_cut(H5Writer& checkpoint, const DistributedMesh& mesh);

/// As the run was cut that wrote it, if it had as many ranks as there are now; else by what is near each
/// other in it. Throws InputError like `read_checkpoint`, when it is asked.
Cut cut_of_checkpoint(const std::filesystem::path& path);

/// By what is near each other in a checkpoint, whoever wrote it.
Cut cut_by_checkpoint(const std::filesystem::path& path);

} // namespace taut
