#pragma once
#include "src/time/simulation.hpp"

namespace taut {

/// Collects what `summary.json` tells about a run: the verdict, and the figures behind it.
class Summary : public Observer {
public:
  /// `setup_seconds`: wall-clock time spent before the run. `simulation` must outlive the summary.
  Summary(const Simulation& simulation, const Case& input, double setup_seconds);

  void after_step(const State& state, const StepRecord& record) override;

  /// The text of `summary.json`, the same on every rank. Collective.
  std::string text(const Outcome& outcome, Global frames, Global intersections, double output_seconds) const;

private:
  double quantile(double fraction) const;

  const Simulation& simulation_;
  const Case& input_;
  double setup_seconds_, began_;
  Global steps_ = 0, iterations_ = 0, linear_iterations_ = 0, velocity_iterations_ = 0;
  int iterations_max_ = 0;
  Global contacts_max_ = 0;
  double strain_max_ = 0, strain_squares_ = 0;
  std::vector<double>
      histogram_; ///< of this rank's |strain| over all accepted steps, in bins of limit / 1000
  PhaseSeconds seconds_;
};

} // namespace taut
