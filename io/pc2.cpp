#include "io/pc2.hpp"

#include "io/whole_file.hpp"
#include "partition/comm.hpp"

#include <fmt/format.h>

#include <array>
#include <bit>
#include <cstring>
#include <fstream>
#include <vector>

namespace taut {
namespace {

namespace fs = std::filesystem;

static_assert(std::endian::native == std::endian::little,
              "PC2 is little-endian, and is written as it lies in memory");

constexpr Global header_size = 32, vertex_size = 12, place_of_frames = 28;
constexpr std::array<char, 12> signature{'P', 'O', 'I', 'N', 'T', 'C', 'A', 'C', 'H', 'E', '2', '\0'};
constexpr std::int32_t version = 1;
constexpr float samples_per_frame = 1;

/// As it lies in the file.
struct Layout {
  std::array<char, 12> signature;
  std::int32_t version, vertices;
  float start, samples_per_frame;
  std::int32_t frames;
};
static_assert(sizeof(Layout) == header_size && offsetof(Layout, frames) == place_of_frames);

/// What MPI says against it; empty if all is well.
std::string words_for(int status) {
  if (status == MPI_SUCCESS) return "";
  std::array<char, MPI_MAX_ERROR_STRING> text{};
  int length = 0;
  MPI_Error_string(status, text.data(), &length);
  return {text.data(), std::size_t(length)};
}

/// The first thing that went wrong on this rank.
std::string write_at(MPI_Comm comm, const fs::path& path, Global begin, std::span<const float> numbers) {
  MPI_File file = MPI_FILE_NULL;
  if (auto words = words_for(MPI_File_open(comm, path.c_str(), MPI_MODE_WRONLY, MPI_INFO_NULL, &file));
      !words.empty())
    return words;
  MPI_Status status;
  std::string words =
      words_for(MPI_File_write_at_all(file, begin, numbers.data(), int(numbers.size()), MPI_FLOAT, &status));
  int written = 0;
  if (words.empty()) MPI_Get_count(&status, MPI_FLOAT, &written);
  if (words.empty() && written != int(numbers.size())) words = "the disk took only a part";
  const std::string at_close = words_for(MPI_File_close(&file));
  return words.empty() ? at_close : words;
}

} // namespace

std::string pc2_header(const Pc2Header& header) {
  const Layout layout{signature, version, header.vertices, header.start, samples_per_frame, header.frames};
  std::string bytes(sizeof layout, '\0');
  std::memcpy(bytes.data(), &layout, sizeof layout);
  return bytes;
}

std::optional<Pc2Header> read_pc2_header(const fs::path& path) {
  Layout layout{};
  std::ifstream in(path, std::ios::binary);
  if (!in.read(reinterpret_cast<char*>(&layout), sizeof layout)) return {};
  if (layout.signature != signature || layout.version != version) return {};
  if (layout.vertices < 0 || layout.frames < 0) return {};
  in.seekg(0, std::ios::end);
  if (std::streamoff(in.tellg()) < header_size + vertex_size * layout.vertices * layout.frames) return {};
  return Pc2Header{layout.vertices, layout.start, layout.frames};
}

void set_pc2_frames(const fs::path& path, std::int32_t frames) {
  std::fstream file(path, std::ios::binary | std::ios::in | std::ios::out);
  file.seekp(place_of_frames);
  file.write(reinterpret_cast<const char*>(&frames), sizeof frames);
  if (!file.flush()) throw InputError(fmt::format("{}: cannot be written; {}", path.string(), writing_cure));
}

/// Room is taken beforehand: a collective write to a full disk may pass for a success.
void write_pc2_frame(MPI_Comm comm, const fs::path& path, std::int32_t frame, std::span<const Vec3> my_rows,
                     Slab rows) {
  const Global size = vertex_size * rows.total, begin = header_size + frame * size;
  on_rank_0(comm, [&] { reserve_in_place(path, begin, begin + size); });
  std::vector<float> numbers;
  numbers.reserve(3 * my_rows.size());
  for (const Vec3& x : my_rows)
    for (const double coordinate : x) numbers.push_back(float(coordinate));
  const std::string words = write_at(comm, path, begin + vertex_size * rows.first, numbers);
  std::optional<std::string> error;
  if (!words.empty())
    error = fmt::format("{}: frame {} cannot be written: {}; {}", path.string(), frame, words, writing_cure);
  agree(comm, error);
  on_rank_0(comm, [&] { set_pc2_frames(path, frame + 1); });
}

} // namespace taut
