#pragma once
#include <mpi.h>

#include <csignal>

namespace taut {

/// While it lives, SIGTERM, SIGINT and SIGUSR1 do not end the program: they ask it to end between two steps.
/// One at a time; it stands before a run is set up, which may take minutes.
class StopSignal {
public:
  StopSignal();
  ~StopSignal(); ///< the signals mean again what they meant before
  StopSignal(const StopSignal&) = delete;
  StopSignal& operator=(const StopSignal&) = delete;

  /// Whether any rank has been asked. Collective.
  bool received(MPI_Comm comm) const;

private:
  static constexpr int signals[] = {SIGTERM, SIGINT, SIGUSR1};
  struct sigaction before_[3];
};

} // namespace taut
