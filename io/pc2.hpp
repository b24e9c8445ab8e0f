#pragma once
#include "partition/mesh_slab.hpp"
#include "partition/types.hpp"

#include <mpi.h>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>

/// Point caches (PC2), which Blender, 3ds Max and Maya read: the positions of vertices, frame by frame, as
/// float32 x y z; vertex i of frame f is at byte 32 + 12 (f n + i). The header before them says how many
/// frames are whole. It is brought up to date after each, so that a file which is being written, or was left
/// so, can be read at any time.
namespace taut {

struct Pc2Header {
  std::int32_t vertices = 0; ///< n
  float start = 0;           ///< number of the first frame of the file, where frames are counted
  std::int32_t frames = 0;
};

/// The 32 bytes of a file without frames.
std::string pc2_header(const Pc2Header& header);

/// None if the file is no point cache, or shorter than its header says. Not collective.
std::optional<Pc2Header> read_pc2_header(const std::filesystem::path& path);

/// Makes the first `frames` frames of a file all that it has. Not collective. Throws InputError if the system
/// refuses.
void set_pc2_frames(const std::filesystem::path& path, std::int32_t frames);

/// Writes frame `frame` of a file that has those before it, of whose vertices this rank gives the rows
/// `rows`; then the file has one more, and none behind. Collective. Throws InputError on all ranks if the
/// frame cannot be written; the file then has the frames before it.
void write_pc2_frame(MPI_Comm comm, const std::filesystem::path& path, std::int32_t frame,
                     std::span<const Vec3> my_rows, Slab rows);

} // namespace taut
