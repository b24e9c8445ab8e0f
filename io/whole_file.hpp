#pragma once
#include <mpi.h>

#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>

/// Files that are either whole or not there: they are written under a temporary name and renamed when
/// complete, so that whoever reads the folder, or a run that was cut off, never meets half a file.
namespace taut {

/// What a file outlives once it has its name: the program, or the machine too, for which one must wait until
/// it is on the disk.
enum class Outlives { program, machine };

/// What cures a failure to write, in the words of messages.
inline constexpr const char* writing_cure = "check that the folder exists, may be written to and has room";

/// The temporary name of `path` while it is being written: the same folder, ".part" added.
std::filesystem::path part_of(const std::filesystem::path& path);

/// Makes `part_of(path)` the file that begins with these bytes, and so far has no others. Not collective:
/// rank 0 only. Throws `InputError` if the system refuses.
void begin_part(const std::filesystem::path& path, std::string_view bytes);

/// Adds bytes to the end of the file `part_of(path)`, which exists. Not collective: rank 0 only. Throws
/// `InputError` if the system refuses.
void append_to_part(const std::filesystem::path& path, std::string_view bytes);

/// Claims room on the disk for bytes [begin, end) of the file `part_of(path)`, which exists; what is written
/// there later cannot fail for want of room. Not collective: rank 0 only. Throws `InputError` if there is
/// none.
void reserve(const std::filesystem::path& path, std::int64_t begin, std::int64_t end);

/// The same in the file `path` itself, one that grows under its own name.
void reserve_in_place(const std::filesystem::path& path, std::int64_t begin, std::int64_t end);

/// Gives the complete file `part_of(path)` the name `path`. Not collective: rank 0 only. Throws `InputError`
/// if the system refuses.
void publish(const std::filesystem::path& path, Outlives outlives);

/// Files that have their names outlive the machine from here on; those that somebody took away are passed
/// over. The list of rank 0 counts. Collective. Throws `InputError` on all ranks if the system refuses.
void make_lasting(MPI_Comm comm, std::span<const std::filesystem::path> files);

/// Writes `text` (that of rank 0 counts) to `path`, replacing an earlier file as a whole. Collective.
/// Throws `InputError` on all ranks if it cannot be written; the earlier file then stays as it was.
void write_text_whole(MPI_Comm comm, const std::filesystem::path& path, std::string_view text,
                      Outlives outlives = Outlives::machine);

} // namespace taut
