#pragma once
#include "partition/types.hpp"

#include <mpi.h>

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace taut::garment {

/// Names of sets of vertices, each ascending.
using Labels = std::map<std::string, std::vector<Global>>;

/// Those of rank 0, on all ranks. Collective.
Labels share_labels(MPI_Comm comm, const Labels& labels);

/// Those in a mesh file (write_mesh.hpp), on all ranks; none in a file without. Collective; throws
/// `InputError`.
Labels read_labels(MPI_Comm comm, const std::filesystem::path& path);

} // namespace taut::garment
