#pragma once
#include "src/time/observer.hpp"

namespace taut {

/// What a run adds up over its steps, those before it was resumed included.
struct Totals {
  Global steps = 0;
  StepCounts counts;
  Global iterations_max = 0, contacts_max = 0; ///< of any step
  Global intersections = 0;                    ///< found by IntersectionCheck
  double residual_max = 0;                     ///< of any step, see StepReport
  double strain_max = 0;
  double edge_strain_max = 0, average_strain_max = 0; ///< the same apart, see Strain
  double face_strain_max = 0;
  double strain_squares = 0; ///< of the rms strain of each step
  double strain_limit = 0;   ///< that of the bins of `histogram`
  /// Of |strain| over all edges and accepted steps: bin b counts those up to b / (bins - 1) of the limit, the
  /// last also those beyond it. What the ranks hold adds up to the whole.
  std::vector<double> histogram;
  double seconds = 0, setup_seconds = 0, output_seconds = 0; ///< on the clock
};

/// Visits all of it, with the names in a checkpoint: `visit(name, number)`, `visit.added_up(name, list)`.
template<class T, class V>
void visit_totals(T& totals, V& visit) {
  visit("steps", totals.steps);
  visit("iterations", totals.counts.iterations);
  visit("linear_iterations", totals.counts.linear_iterations);
  visit("velocity_iterations", totals.counts.velocity_iterations);
  visit("iterations_max", totals.iterations_max);
  visit("contacts_max", totals.contacts_max);
  visit("contacts", totals.counts.contacts);
  visit("contacts_if_even", totals.counts.contacts_if_even);
  visit("contacts_across", totals.counts.contacts_across);
  visit("smallest_gap", totals.counts.smallest_gap);
  visit("intersections", totals.intersections);
  visit("residual_max", totals.residual_max);
  visit("strain_max", totals.strain_max);
  visit("edge_strain_max", totals.edge_strain_max);
  visit("average_strain_max", totals.average_strain_max);
  visit("face_strain_max", totals.face_strain_max);
  visit("strain_squares", totals.strain_squares);
  visit("strain_limit", totals.strain_limit);
  visit.added_up("strain_histogram", totals.histogram);
  visit("velocity_seconds", totals.counts.velocity_seconds);
  visit("projection_seconds", totals.counts.projection_seconds);
  visit("contact_seconds", totals.counts.contact_seconds);
  visit("seconds", totals.seconds);
  visit("cpu_seconds", totals.counts.cpu_seconds);
  visit("setup_seconds", totals.setup_seconds);
  visit("output_seconds", totals.output_seconds);
}

} // namespace taut
