#pragma once
#include "src/filters/step_report.hpp"
#include "src/state/state.hpp"

#include <vector>

namespace taut {

/// Joules, over all ranks. `potential` in the order of `energy_names`.
struct Energies {
  double kinetic = 0;
  std::vector<double> potential;
};

/// What an accepted step was like.
struct StepRecord {
  double dt = 0;       ///< s
  int rejected = 0;    ///< attempts thrown away before this one
  StepCounts counts;   ///< rejected attempts included in its seconds alone
  double residual = 0; ///< see StepReport
  Strain strain;
  double face_strain = 0; ///< see Acceptance
  double depth = 0;       ///< m the lowest point has come down since the start
  Energies energies;
  std::vector<Vec3> pin_forces; ///< N, of each pin on all its vertices together
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
