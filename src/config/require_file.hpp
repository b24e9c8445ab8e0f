#pragma once
#include "src/config/case.hpp"

#include <mpi.h>

namespace taut::config {

/// Throws InputError, naming the case and `key`, unless there is a file `file`, a path as the case has it.
/// Collective.
void require_file(MPI_Comm comm, const Case& input, const std::string& key,
                  const std::filesystem::path& file);

} // namespace taut::config
