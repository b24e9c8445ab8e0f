// What Fast Projection leaves of the force balance [G07 figure 3]: force_residual CASE STEP...
//
// It runs the case; after each frame it takes one step of each of the
// lengths from there, projects it, and prints a line of CSV with
//
//     |F| / |M g|,   F = M (x - x0)/h^2 + J(x)^T lambda,
//
// after the first and the last iteration. The exact method, icd, ends where F = 0; x0 is where the vertices
// would be without any tension, so nothing is carried here from the step before.
#include "src/constraints/edge_constraints.hpp"
#include "src/filters/fast_projection.hpp"
#include "src/linear/session.hpp"
#include "src/time/implicit_euler.hpp"
#include "src/time/simulation.hpp"

#include <fmt/format.h>

#include <cstdlib>
#include <fstream>
#include <iterator>

using namespace taut;

namespace {

/// A step of `dt` from a state of the simulation: candidate, then projection.
class Step {
public:
  Step(const Simulation& simulation, const Case& input)
      : simulation_(simulation), input_(input), pattern_(simulation.cloth().mesh),
        predictor_(simulation.cloth(), pattern_, simulation.forces(), input.velocity, input.time.integrator,
                   SolverOptions::Preconditioner::axis),
        freedom_(simulation.cloth().mesh.vertices.size()) {}

  void predict(double dt) {
    dt_ = dt;
    start_ = simulation_.state();
    std::fill(start_.multipliers.force_density.begin(), start_.multipliers.force_density.end(), 0.0);
    candidate_.velocities = start_.velocities;
    candidate_.multipliers.force_density.assign(simulation_.cloth().mesh.edges.size(), 0.0);
    simulation_.pins().prescribe(start_, dt, freedom_, candidate_.velocities);
    predictor_.predict({start_, dt, start_}, freedom_, candidate_.velocities, candidate_.reported.reaction);
  }

  struct Left {
    double residual; ///< |F| / |M g|
    Global iterations;
    bool reached; ///< the limit
  };

  /// After at most `iterations` of the projection.
  Left project(int iterations) const {
    config::Inextensibility options = simulation_.inextensibility();
    options.max_iterations = iterations;
    FastProjection<EdgeSet> projection(simulation_.cloth(), options);
    Candidate end = candidate_;
    const FilterReport report = projection.apply(start_, dt_, freedom_, end);
    return {residual(end), report.iterations, report.failure.empty()};
  }

private:
  double residual(const Candidate& end) const {
    const Cloth& cloth = simulation_.cloth();
    std::vector<Vec3> x = start_.positions;
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += dt_ * end.velocities[i];
    EdgeConstraints constraints(cloth, simulation_.inextensibility());
    constraints.start(dt_, freedom_);
    constraints.evaluate(x);
    std::vector<double> mu(end.multipliers.force_density.size());
    constraints.to_mu(end.multipliers.force_density, mu);
    double force = 0, weight = 0;
    for (Local i = 0; i < cloth.mesh.vertices.owned; ++i) {
      if (freedom_.is_held(i)) continue;
      const Vec3 moved = dt_ * (end.velocities[i] - candidate_.velocities[i]);
      const Vec3 f = cloth.mass[i] * moved + constraints.pull(i, constraints.gradients(), mu);
      force += f.squaredNorm();
      weight += std::pow(cloth.mass[i] * input_.gravity.largest(), 2);
    }
    const MPI_Comm comm = cloth.mesh.comm;
    return std::sqrt(sum_over(comm, force) / sum_over(comm, weight)) / (dt_ * dt_);
  }

  const Simulation& simulation_;
  const Case& input_;
  Pattern pattern_;
  ImplicitEuler predictor_;
  State start_; ///< without the tension of the step before
  Candidate candidate_;
  Freedom freedom_;
  double dt_ = 0;
};

class Watch : public Observer {
public:
  Watch(const Simulation& simulation, const Case& input, std::vector<double> steps)
      : simulation_(simulation), step_(simulation, input), most_(input.inextensibility.max_iterations),
        steps_(std::move(steps)) {}

  void after_frame(const State& state, Global) override {
    for (const double dt : steps_) {
      step_.predict(dt);
      const Step::Left first = step_.project(1), last = step_.project(most_);
      if (rank_of(simulation_.cloth().mesh.comm) == 0 && last.reached)
        fmt::print("{:.6g},{:.6g},{},{:.6g},{:.6g}\n", state.time, dt, last.iterations, first.residual,
                   last.residual);
    }
  }

private:
  const Simulation& simulation_;
  Step step_;
  int most_;
  std::vector<double> steps_;
};

std::string text_of(const std::string& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

} // namespace

int main(int argc, char** argv) {
  const Session session(argc, argv, {});
  const MPI_Comm comm = MPI_COMM_WORLD;
  try {
    if (argc < 3) throw InputError("force_residual CASE STEP...: give a case and steps in seconds");
    const std::string file = argv[1];
    const Case input = read_case(text_of(file), file);
    std::vector<double> steps;
    for (int k = 2; k < argc; ++k) steps.push_back(std::atof(argv[k]));
    Simulation simulation(comm, input);
    Watch watch(simulation, input, steps);
    if (rank_of(comm) == 0) fmt::print("time_s,dt_s,iterations,first,last\n");
    Observer* const observers[] = {&watch};
    const Outcome outcome = simulation.run(observers);
    if (!outcome.completed()) throw InputError(outcome.reason);
  } catch (const InputError& e) {
    if (rank_of(comm) == 0) fmt::print(stderr, "force_residual: {}\n", e.what());
    return 2;
  }
}
