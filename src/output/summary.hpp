#pragma once
#include "src/output/intersection_check.hpp"
#include "src/output/totals.hpp"
#include "src/time/simulation.hpp"

namespace taut {

/// Collects what `summary.json` tells about a run: the verdict, and the figures behind it.
class Summary : public Observer {
public:
  /// Adds to what the run had before it was resumed. `began`: MPI_Wtime() when this program did. All
  /// references must outlive the summary.
  Summary(const Simulation& simulation, const Case& input, const IntersectionCheck& intersections,
          Totals earlier, double began);

  void after_step(const State& state, const StepRecord& record) override;

  /// Until now; `output_seconds` were spent on output since the program began.
  Totals totals(double output_seconds) const;

  /// The text of `summary.json`, the same on every rank. Collective.
  std::string text(const Outcome& outcome, Global frames, double output_seconds) const;

private:
  const Simulation& simulation_;
  const Case& input_;
  const IntersectionCheck& intersections_;
  Totals totals_;
  double began_;
};

} // namespace taut
