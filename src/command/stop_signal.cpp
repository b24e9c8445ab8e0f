#include "src/command/stop_signal.hpp"

#include "partition/comm.hpp"

namespace taut {

namespace {

volatile std::sig_atomic_t asked = 0; // a signal handler can reach nothing else

void note_signal(int) { asked = 1; }

} // namespace

StopSignal::StopSignal() {
  asked = 0;
  struct sigaction action {};
  action.sa_handler = note_signal;
  action.sa_flags = SA_RESTART; // a write in progress goes on
  sigemptyset(&action.sa_mask);
  for (int k = 0; k < 3; ++k) sigaction(signals[k], &action, &before_[k]);
}

StopSignal::~StopSignal() {
  for (int k = 0; k < 3; ++k) sigaction(signals[k], &before_[k], nullptr);
}

bool StopSignal::received(MPI_Comm comm) const { return any_of(comm, asked != 0); }

} // namespace taut
