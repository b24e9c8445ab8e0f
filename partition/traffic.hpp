#pragma once
#include "partition/comm.hpp"

#include <array>
#include <string_view>

/// What the ranks say to each other, counted by MPI's profiling interface: every call that passes a message
/// or meets in a collective, those of PETSc and HDF5 included, is set down to the phase it falls in. That
/// interface knows nothing but functions, so the counts are the program's, not an object's; until
/// `count_traffic` is called nothing is counted.
namespace taut {

enum class Phase { setup, velocity, projection, contact, output, other };
constexpr std::array<std::string_view, 6> phase_names{"setup",   "velocity", "projection",
                                                      "contact", "output",   "other"};

/// Of one rank in one phase.
struct PhaseTraffic {
  Global entered = 0;       ///< how often the phase began
  double seconds = 0;       ///< on the clock
  double work = 0;          ///< s of the processor, without those inside of MPI
  Global messages = 0;      ///< sent to other ranks, those of halos included
  Global bytes = 0;         ///< in these
  Global neighbours = 0;    ///< other ranks these went to; of communicators of all ranks
  Global reductions = 0;    ///< over all ranks, to one or to all
  Global collectives = 0;   ///< other calls in which all ranks meet
  Global halo_updates = 0;  ///< exchanges by `Plan`, those of yarns included
  Global halo_messages = 0; ///< sent in these to other ranks
  Global halo_bytes = 0;
};

/// From here on everything is counted, first in the phase `setup`. Not collective.
void count_traffic();

/// This rank's counts so far, by phase. Not collective.
std::array<PhaseTraffic, phase_names.size()> traffic();

/// What happens in its life belongs to a phase, and then again to the one before.
class PhaseScope {
public:
  explicit PhaseScope(Phase phase);
  ~PhaseScope();
  PhaseScope(const PhaseScope&) = delete;

private:
  Phase before_;
};

/// What is sent in its life is part of a halo update.
class HaloScope {
public:
  HaloScope();
  ~HaloScope();
  HaloScope(const HaloScope&) = delete;
};

} // namespace taut
