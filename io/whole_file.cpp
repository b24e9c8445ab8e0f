#include "io/whole_file.hpp"

#include "partition/comm.hpp"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <set>
#include <string>
#include <unistd.h>

namespace taut {
namespace {

namespace fs = std::filesystem;

/// A POSIX file descriptor that closes itself; negative if the file could not be opened.
class Descriptor {
public:
  Descriptor(const fs::path& path, int flags) : fd_(::open(path.c_str(), flags | O_CLOEXEC, 0666)) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (fd_ >= 0) ::close(fd_);
  }
  int get() const { return fd_; }

private:
  int fd_;
};

[[noreturn]] void refuse(const fs::path& path, int error = errno) {
  throw InputError(
      fmt::format("{}: cannot be written: {}; {}", path.string(), std::strerror(error), writing_cure));
}

void write_all(const Descriptor& file, std::string_view text, const fs::path& path) {
  while (!text.empty()) {
    const ssize_t written = ::write(file.get(), text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) refuse(path);
    text.remove_prefix(static_cast<std::size_t>(written));
  }
}

void flush(const Descriptor& file, const fs::path& path) {
  if (::fsync(file.get()) != 0) refuse(path);
}

/// A name lasts only once its folder is on the disk; some file systems cannot do that, and need not.
void flush_name(const fs::path& path) {
  const Descriptor folder(path.has_parent_path() ? path.parent_path() : fs::path("."),
                          O_RDONLY | O_DIRECTORY);
  if (folder.get() >= 0) ::fsync(folder.get());
}

/// In `file`, for what is to be known as `path`.
void claim(const fs::path& file, const fs::path& path, std::int64_t begin, std::int64_t end) {
  if (begin >= end) return;
  const Descriptor descriptor(file, O_WRONLY);
  if (descriptor.get() < 0) refuse(path);
  int error = EINTR;
  while (error == EINTR) error = ::posix_fallocate(descriptor.get(), begin, end - begin);
  if (error != 0) refuse(path, error);
}

} // namespace

fs::path part_of(const fs::path& path) { return fs::path(path) += ".part"; }

void begin_part(const fs::path& path, std::string_view bytes) {
  const Descriptor file(part_of(path), O_WRONLY | O_CREAT | O_TRUNC);
  if (file.get() < 0) refuse(path);
  write_all(file, bytes, path);
}

void append_to_part(const fs::path& path, std::string_view bytes) {
  const Descriptor file(part_of(path), O_WRONLY | O_APPEND);
  if (file.get() < 0) refuse(path);
  write_all(file, bytes, path);
}

void reserve(const fs::path& path, std::int64_t begin, std::int64_t end) {
  claim(part_of(path), path, begin, end);
}

void reserve_in_place(const fs::path& path, std::int64_t begin, std::int64_t end) {
  claim(path, path, begin, end);
}

void publish(const fs::path& path, Outlives outlives) {
  const fs::path part = part_of(path);
  if (outlives == Outlives::machine) {
    const Descriptor file(part, O_RDONLY);
    if (file.get() < 0) refuse(path);
    flush(file, path);
  }
  if (::rename(part.c_str(), path.c_str()) != 0) refuse(path);
  if (outlives == Outlives::machine) flush_name(path);
}

void make_lasting(MPI_Comm comm, std::span<const fs::path> files) {
  on_rank_0(comm, [&] {
    for (const fs::path& path : files) {
      const Descriptor file(path, O_RDONLY);
      if (file.get() >= 0) flush(file, path);
    }
    std::set<fs::path> folders;
    for (const fs::path& path : files)
      if (folders.insert(path.parent_path()).second) flush_name(path);
  });
}

void write_text_whole(MPI_Comm comm, const fs::path& path, std::string_view text, Outlives outlives) {
  on_rank_0(comm, [&] {
    try {
      begin_part(path, text);
      publish(path, outlives);
    } catch (const InputError&) {
      std::error_code ignored; // the first failure is the one to tell
      fs::remove(part_of(path), ignored);
      throw;
    }
  });
}

} // namespace taut
