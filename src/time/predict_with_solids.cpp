#include "src/time/predict_with_solids.hpp"

#include "partition/traffic.hpp"

namespace taut {

namespace {

/// Predictions that are made again in a step; what solids still pull then is let go in the next step.
constexpr int most_releases = 1;

} // namespace

PredictWithSolids::PredictWithSolids(const StepperParts& parts, const Case& input)
    : pins_(parts.pins), filters_(parts, input),
      predictor_(parts.cloth, parts.pattern, parts.forces, input.velocity, input.time.integrator,
                 velocity_preconditioner(parts.resolved)),
      solids_(parts.cloth, parts.obstacles, input), freedom_(parts.cloth.mesh.vertices.size()) {
  parts.forces.push_back(std::make_unique<SolidFriction>(solids_));
}

StepReport PredictWithSolids::propose(const State& state, double dt, Candidate& candidate) {
  const double began = MPI_Wtime();
  const StepStart start = alter(state, dt, candidate);
  StepReport report = predict(start, candidate);
  report.velocity_seconds = MPI_Wtime() - began;
  filters_.apply(start, freedom_, candidate, report);
  solids_.note_forces(candidate);
  return report;
}

/// Solids alter positions: the step then starts from others than those at which forces are taken.
StepStart PredictWithSolids::alter(const State& state, double dt, Candidate& candidate) {
  candidate.velocities = state.velocities;
  pins_.prescribe(state, dt, freedom_, candidate.velocities);
  solids_.find(state, dt, freedom_);
  altered_ = state;
  const auto y = solids_.alteration();
  for (std::size_t i = 0; i < y.size(); ++i) altered_.positions[i] += y[i];
  return {altered_, dt, state};
}

/// Where solids would have to pull, the prediction is made again without them.
StepReport PredictWithSolids::predict(const StepStart& start, Candidate& candidate) {
  const PhaseScope phase(Phase::velocity);
  filters_.carry_tension(start.state, candidate);
  StepReport report;
  for (int round = 0;; ++round) {
    candidate.velocities = start.state.velocities;
    pins_.prescribe(start.state, start.dt, freedom_, candidate.velocities);
    solids_.prescribe(freedom_, candidate.velocities);
    const StepReport predicted =
        predictor_.predict(start, freedom_, candidate.velocities, candidate.reported.reaction);
    report += predicted;
    report.failure = predicted.failure;
    if (!report.failure.empty()) return report;
    if (round == most_releases || !solids_.let_go(candidate.reported.reaction)) break;
  }
  solids_.loosen(freedom_);
  return report;
}

} // namespace taut
