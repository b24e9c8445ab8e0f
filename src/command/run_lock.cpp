#include "src/command/run_lock.hpp"

#include "partition/comm.hpp"
#include "src/output/run_files.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <string>

namespace taut::command {

namespace {

namespace fs = std::filesystem;

std::string this_process() {
  std::array<char, 256> host{};
  gethostname(host.data(), host.size() - 1);
  return fmt::format("process {} on {}", getpid(), host.data());
}

/// Who stands in the file, on whose first line.
std::string owner_in(int descriptor) {
  std::array<char, 512> text{};
  const ssize_t size = pread(descriptor, text.data(), text.size(), 0);
  const std::string_view all(text.data(), std::size_t(std::max<ssize_t>(size, 0)));
  return std::string(all.substr(0, all.find('\n')));
}

/// Its last owner removes the file, perhaps between our opening and our locking of it.
bool is_still(int descriptor, const fs::path& file) {
  struct stat ours, there;
  return fstat(descriptor, &ours) == 0 && stat(file.c_str(), &there) == 0 && ours.st_ino == there.st_ino &&
         ours.st_dev == there.st_dev;
}

[[noreturn]] void refuse(const fs::path& folder, int error) {
  throw InputError(fmt::format("{}: cannot be locked: {}; the folder must be writable, on a file system that "
                               "knows locks (flock)",
                               folder.string(), std::strerror(error)));
}

/// The descriptor of the locked file.
int lock(const fs::path& folder, const fs::path& file) {
  for (;;) {
    const int descriptor = open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (descriptor < 0) refuse(folder, errno);
    if (flock(descriptor, LOCK_EX | LOCK_NB) == 0) {
      if (is_still(descriptor, file)) return descriptor;
      close(descriptor);
      continue;
    }
    const int error = errno;
    const std::string owner = owner_in(descriptor);
    close(descriptor);
    if (error == EINTR) continue;
    if (error != EWOULDBLOCK) refuse(folder, error);
    throw InputError(fmt::format("{}: {} is writing in this folder; wait until it has ended, stop it (by "
                                 "SIGTERM), or choose another folder",
                                 folder.string(), owner.empty() ? "another process" : owner));
  }
}

/// Whoever finds the lock must find its owner: what stands there is replaced in one piece.
void sign(int descriptor) {
  const std::string line = this_process() + "\n";
  if (ftruncate(descriptor, 0) != 0 || pwrite(descriptor, line.data(), line.size(), 0) < 0) {
    // The lock holds all the same, only without a name.
  }
}

} // namespace

RunLock::RunLock(MPI_Comm comm, const fs::path& folder) : file_(folder / run_files::lock) {
  on_rank_0(comm, [&] {
    descriptor_ = lock(folder, file_);
    if (const std::string dead = owner_in(descriptor_); !dead.empty())
      fmt::print("{}: {} wrote here and ended without giving back its lock; it is taken over\n",
                 folder.string(), dead);
    sign(descriptor_);
  });
}

RunLock::~RunLock() {
  if (descriptor_ < 0) return;
  std::error_code ignored; // a folder that was taken away takes it along
  fs::remove(file_, ignored);
  close(descriptor_);
}

} // namespace taut::command
