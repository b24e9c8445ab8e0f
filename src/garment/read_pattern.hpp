#pragma once
#include "src/garment/sewing_pattern.hpp"

#include <mpi.h>

#include <filesystem>
#include <string>

namespace taut::garment {

/// Reads a pattern: a specification of GarmentCode (JSON), or the same written by hand in YAML (README.md
/// here). What is found to be wrong with its words, numbers, loops and stitches is an `InputError`,
/// "file:line:column: panels.front.edges.3: what is wrong; cure". Whether panels have a sound shape is for
/// `check_panels` to say. `file_name` ends in .json for the former; what other keys stand there is passed
/// over. Not collective.
SewingPattern parse_pattern(const std::string& text, const std::string& file_name);

/// Throws `InputError`, naming panel, edges and place, if a panel crosses itself or has no area, or is far
/// larger than any garment. Not collective.
void check_panels(const SewingPattern& pattern);

/// Both, of a file that rank 0 reads; the same on all ranks. Collective.
SewingPattern read_pattern(MPI_Comm comm, const std::filesystem::path& file);

} // namespace taut::garment
