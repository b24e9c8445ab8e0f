#include "src/time/predict_and_filter.hpp"

#include "partition/traffic.hpp"

namespace taut {

PredictAndFilter::PredictAndFilter(const StepperParts& parts, const Case& input)
    : pins_(parts.pins), integrator_(input.time.integrator), filters_(parts, input),
      predictor_(parts.cloth, parts.pattern, parts.forces, input.velocity, input.time.integrator,
                 velocity_preconditioner(parts.resolved)),
      freedom_(parts.cloth.mesh.vertices.size()) {}

StepReport PredictAndFilter::propose(const State& state, double dt, Candidate& candidate) {
  const double began = MPI_Wtime();
  const StepStart start = integrator_.start(state, dt);
  StepReport report = predict(start, candidate);
  report.velocity_seconds = MPI_Wtime() - began;
  filters_.apply(start, freedom_, candidate, report);
  return report;
}

StepReport PredictAndFilter::predict(const StepStart& start, Candidate& candidate) {
  const PhaseScope phase(Phase::velocity);
  filters_.carry_tension(start.state, candidate);
  candidate.velocities = start.state.velocities;
  pins_.prescribe(start.state, start.dt, freedom_, candidate.velocities);
  return predictor_.predict(start, freedom_, candidate.velocities, candidate.reported.reaction);
}

} // namespace taut
