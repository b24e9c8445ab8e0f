#pragma once
#include <mpi.h>

#include <filesystem>
#include <string>

/// The CRC-32 of a file (that of gzip and PNG), in one more line behind its bytes: "taut crc32 89abcdef".
/// HDF5 passes over what stands behind its own end, so such a file remains one for every program that reads
/// HDF5. All of the file is covered, HDF5's own tables and attributes included, and a damage is seen before
/// HDF5 is let near it, which may hang or crash on one. Each rank reads its part of the bytes.
namespace taut {

/// Whether a file must have a checksum: those of a run do, those that others wrote have none.
enum class Checksum { optional, required };

/// Adds the line to the complete file `part_of(path)` (whole_file.hpp). Collective. Throws InputError on all
/// ranks if the file cannot be read or written.
void append_checksum(MPI_Comm comm, const std::filesystem::path& path);

/// What is wrong with a file, in words that name it: it is not what it was when its checksum was added, has
/// none that is required, or cannot be read. Empty if it is sound. The same on all ranks. Collective.
std::string damage_of(MPI_Comm comm, const std::filesystem::path& path, Checksum needed);

/// Throws that as InputError on all ranks. Collective.
void verify_checksum(MPI_Comm comm, const std::filesystem::path& path, Checksum needed);

} // namespace taut
