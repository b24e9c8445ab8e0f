#include "io/checksum.hpp"

#include "io/whole_file.hpp"
#include "partition/comm.hpp"
#include "partition/mesh_slab.hpp"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <fstream>
#include <string>

namespace taut {
namespace {

namespace fs = std::filesystem;
using Crc = std::uint32_t;

constexpr std::string_view mark = "\ntaut crc32 ";
constexpr Global digits = 8, line_size = Global(mark.size()) + digits + 1;

std::string line_of(Crc crc) { return fmt::format("{}{:08x}\n", mark, crc); }

/// CRC-32 of bytes [first, first + count) of a file; says what went wrong if they cannot be read.
Crc crc_of(const fs::path& file, Global first, Global count, std::optional<std::string>& error) {
  constexpr Global block = 1 << 18;
  std::string bytes(std::size_t(std::min(block, count)), '\0');
  std::ifstream in(file, std::ios::binary);
  in.seekg(first);
  auto crc = crc32_z(0, nullptr, 0);
  for (Global left = count; left > 0; left -= block) {
    const auto size = std::size_t(std::min(block, left));
    if (!in.read(bytes.data(), std::streamsize(size))) {
      error = fmt::format("{}: cannot be read: {}", file.string(), std::strerror(errno));
      break;
    }
    crc = crc32_z(crc, reinterpret_cast<const Bytef*>(bytes.data()), size);
  }
  return Crc(crc);
}

/// CRC-32 of the first `size` bytes of a file. That of a whole is the sum, modulo 2, of those of its parts,
/// each moved on by the bytes behind it: so it is the same however many ranks share the reading.
Crc shared_crc(MPI_Comm comm, const fs::path& file, Global size) {
  const Slab mine = slab_of(size, size_of(comm), rank_of(comm));
  std::optional<std::string> error;
  const Crc part = crc_of(file, mine.first, mine.count, error);
  agree(comm, error);
  auto crc = Crc(crc32_combine(part, 0, size - mine.first - mine.count));
  MPI_Allreduce(MPI_IN_PLACE, &crc, 1, MPI_UINT32_T, MPI_BXOR, comm);
  return crc;
}

/// The last bytes of a file, as many as a checksum takes.
std::string last_line(const fs::path& file, Global size) {
  std::string line(std::size_t(std::min(line_size, size)), '\0');
  std::ifstream in(file, std::ios::binary);
  in.seekg(size - Global(line.size()));
  in.read(line.data(), std::streamsize(line.size()));
  return line;
}

/// Its size, seen by rank 0.
Global size_of_file(MPI_Comm comm, const fs::path& file) {
  Global size = -1;
  on_rank_0(comm, [&] {
    std::error_code error;
    size = Global(fs::file_size(file, error));
    if (error) throw InputError(fmt::format("{}: no such file, or it may not be read", file.string()));
  });
  MPI_Bcast(&size, 1, MPI_INT64_T, 0, comm);
  return size;
}

} // namespace

void append_checksum(MPI_Comm comm, const fs::path& path) {
  const fs::path file = part_of(path);
  const Crc crc = shared_crc(comm, file, size_of_file(comm, file));
  on_rank_0(comm, [&] { append_to_part(path, line_of(crc)); });
}

std::string damage_of(MPI_Comm comm, const fs::path& path, Checksum needed) try {
  const Global size = size_of_file(comm, path);
  const std::string line = broadcast_text(comm, rank_of(comm) == 0 ? last_line(path, size) : "");
  if (!line.starts_with(mark)) {
    if (needed == Checksum::optional) return "";
    return fmt::format(
        "{}: it does not end with its checksum: it is damaged, not whole, or was not written by "
        "this version of taut",
        path.string());
  }
  const Crc crc = shared_crc(comm, path, size - line_size);
  if (line_of(crc) == line) return "";
  return fmt::format("{}: damaged: its bytes have the checksum {:08x}, but had {} when they were written",
                     path.string(), crc, line.substr(mark.size(), digits));
} catch (const InputError& unreadable) { // on all ranks alike
  return unreadable.what();
}

void verify_checksum(MPI_Comm comm, const fs::path& path, Checksum needed) {
  if (const std::string damage = damage_of(comm, path, needed); !damage.empty())
    throw InputError(damage + "; put a sound copy of it in its place");
}

} // namespace taut
