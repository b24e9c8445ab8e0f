#pragma once
#include "io/hdf5.hpp"

namespace taut {

constexpr Global checkpoint_format = 6;
constexpr const char* checkpoint_format_name = "taut_checkpoint";

/// Throws InputError for a file that is no checkpoint of this format. Collective.
void check_checkpoint_format(const H5Reader& file);

} // namespace taut
