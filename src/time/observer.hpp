#pragma once
#include "src/state/state.hpp"

#include <string>
#include <vector>

namespace taut {

/// What a step, or a run, took: seconds on the clock by phase, and of the processors.
struct PhaseSeconds {
  double velocity = 0;
  double projection = 0; ///< without `contact`
  double contact = 0;    ///< finding what can meet, and moving without meeting
  double cpu = 0;        ///< of all phases and all ranks; waiting for other ranks counts

  PhaseSeconds& operator+=(const PhaseSeconds& other) {
    velocity += other.velocity;
    projection += other.projection;
    contact += other.contact;
    cpu += other.cpu;
    return *this;
  }
};

/// Joules, over all ranks. `potential` in the order of `energy_names`.
struct Energies {
  double kinetic = 0;
  std::vector<double> potential;
};

/// What an accepted step was like.
struct StepRecord {
  double dt = 0;               ///< s
  int rejected = 0;            ///< attempts thrown away before this one
  int velocity_iterations = 0; ///< of the velocity's linear solver
  int iterations = 0;          ///< of the projection
  int linear_iterations = 0;   ///< of the projection's linear solver, summed over `iterations`
  Global contacts = 0;         ///< features in reach of each other
  Global contacts_if_even = 0; ///< if every rank had as many as the one with most
  Strain strain;
  double face_strain =
      0;            ///< largest of any triangle along warp or weft, where the limit is for averages of it
  double depth = 0; ///< m the lowest point has come down since the start
  Energies energies;
  std::vector<Vec3> pin_forces; ///< N, of each pin on all its vertices together
  PhaseSeconds seconds;         ///< rejected attempts included
};

/// Watches a run. Observers never change it. All calls are collective.
class Observer {
public:
  virtual ~Observer() = default;
  virtual void at_start(const State&) {}
  virtual void after_step(const State&, const StepRecord&) {}
  /// After the last step of frame `frame` (from 1), a frame being 1 / frame_rate of simulated time.
  virtual void after_frame(const State&, Global /*frame*/) {}
  /// When everybody has seen a step, and the frame if it ended one: the run may be cut here.
  virtual void between_steps(const State&) {}
};

} // namespace taut
