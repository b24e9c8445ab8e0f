#pragma once
#include <mpi.h>

#include <filesystem>

namespace taut::command {

/// While it lives, nobody else writes in the folder of a run. Rank 0 holds `lock` there by flock(2), which
/// the system gives back when the process ends, however it ends; in the file stand its host and process, for
/// those who find it held, and for those who find it left.
class RunLock {
public:
  /// Takes the lock of `folder`, which exists. A lock whose owner is dead is taken over, and that is told on
  /// standard output. Throws InputError if another process holds it. Collective.
  RunLock(MPI_Comm comm, const std::filesystem::path& folder);
  ~RunLock(); ///< the file goes too
  RunLock(const RunLock&) = delete;
  RunLock& operator=(const RunLock&) = delete;

private:
  std::filesystem::path file_;
  int descriptor_ = -1; ///< of rank 0; negative where there is no lock
};

} // namespace taut::command
