// What a step is made of, on one core, beside the memory bandwidth of the moment: kernels SIDE [options of
// Google Benchmark]
//
// The cloth is the square of cases/two-pins while it falls, simulated on 41 x 41 vertices and refined to SIDE
// x SIDE. Bytes are those a kernel cannot do without: what it reads and writes, once each.
#include "src/constraints/edge_set.hpp"
#include "src/linear/session.hpp"
#include "src/linear/yarn_system.hpp"
#include "src/time/simulation.hpp"
#include "tests/petsc_options.hpp"

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>
#include <functional>

using namespace taut;

namespace {

using Kernel = std::function<void()>;

/// `bytes` of one call; 0 where that is no measure.
void measure(const char* name, double bytes, Kernel kernel) {
  benchmark::RegisterBenchmark(name, [bytes, kernel = std::move(kernel)](benchmark::State& state) {
    for (auto _ : state) kernel();
    if (bytes > 0) state.SetBytesProcessed(std::int64_t(bytes * double(state.iterations())));
  })->Unit(benchmark::kMillisecond);
}

constexpr int coarse_side = 41;

double step_of(int side) { return 0.7 / side; } // s, as long as the mesh lets it be

Case falling_cloth(int side) {
  return read_case(fmt::format("cloth: {{grid: {{size: [1, 1], vertices: [{0}, {0}]}}}}\n"
                               "pins: [{{vertices: [0, {1}]}}]\n"
                               "time: {{end: 0.5, max_step: {2}}}\n",
                               side, side - 1, step_of(side)),
                   "kernels.yaml");
}

/// Vectors at the vertices of the coarse grid, row by row, bilinearly at those of a finer one.
std::vector<Vec3> refined(const std::vector<Vec3>& coarse, int side) {
  std::vector<Vec3> fine;
  const double ratio = double(coarse_side - 1) / (side - 1);
  const auto at = [&](int row, int column) { return coarse[std::size_t(row) * coarse_side + column]; };
  for (int i = 0; i < side; ++i)
    for (int j = 0; j < side; ++j) {
      const int k = std::min(int(i * ratio), coarse_side - 2), l = std::min(int(j * ratio), coarse_side - 2);
      const double s = i * ratio - k, t = j * ratio - l;
      fine.emplace_back((1 - s) * ((1 - t) * at(k, l) + t * at(k, l + 1)) +
                        s * ((1 - t) * at(k + 1, l) + t * at(k + 1, l + 1)));
    }
  return fine;
}

/// Puts `fine` where the cloth is at the end of the case on the coarse grid; false if it does not get there.
bool let_fall(Simulation& fine, int side) {
  const Case input = falling_cloth(coarse_side);
  Simulation coarse(MPI_COMM_WORLD, input);
  if (!coarse.run({}).completed()) return false;
  State state = fine.state();
  const OriginalOrder &from = coarse.cloth().mesh.vertex_order, &to = fine.cloth().mesh.vertex_order;
  const State& end = coarse.state();
  to.from_slab<Vec3>(refined(from.to_slab<Vec3>(end.positions), side), state.positions);
  to.from_slab<Vec3>(refined(from.to_slab<Vec3>(end.velocities), side), state.velocities);
  fine.restore(std::move(state), fine.step_size().memory(), 0);
  return true;
}

/// y = a + s b on arrays beyond any cache: what the memory gives [McCalpin's STREAM triad].
void measure_bandwidth() {
  constexpr std::size_t n = std::size_t(1) << 23;
  auto a = std::make_shared<std::vector<double>>(n, 1.0), b = std::make_shared<std::vector<double>>(n, 2.0),
       y = std::make_shared<std::vector<double>>(n, 0.0);
  measure("bandwidth", 24.0 * n, [a, b, y, s = 1.0]() mutable {
    s += 1.0;
    for (std::size_t i = 0; i < n; ++i) (*y)[i] = (*a)[i] + s * (*b)[i];
    benchmark::ClobberMemory();
  });
}

/// The velocity matrix of a step, as the forces of the case make it.
class Velocity {
public:
  explicit Velocity(const Simulation& simulation)
      : state_(simulation.state()), pattern_(simulation.cloth().mesh), forces_(simulation.forces()),
        system_(pattern_, simulation.cloth().mesh.vertices.size()), product_(state_.velocities.size()) {
    assemble();
  }

  void assemble() {
    system_.start(0.005);
    for (const auto& force : forces_) force->add_to(system_, state_);
  }
  void multiply() { system_.matrix().multiply(state_.velocities, product_); }

  /// Of a product: an entry has a value and a column, a rank-one term its vertices and gradients.
  double bytes() const {
    double terms = 0;
    system_.matrix().for_each_rank_one([&](const auto& term) { terms += sizeof(term); });
    return 12.0 * double(pattern_.entries()) + terms + 48.0 * double(product_.size());
  }

private:
  const State& state_;
  Pattern pattern_;
  const Forces& forces_;
  StepSystem system_;
  std::vector<Vec3> product_;
};

/// One projection of a step without carried tension, to 1e-6, with the linear solver of `settings`. Each
/// solve assembles, and factorises or sets up, anew.
class Projection {
public:
  Projection(const Simulation& simulation, int side, config::LinearSolver solver,
             std::vector<test::PetscSetting> settings)
      : simulation_(simulation), side_(side), options_(simulation.inextensibility()),
        settings_(std::move(settings)) {
    options_.solver = solver;
  }

  void operator()(benchmark::State& state) {
    const test::OptionsInForce in_force(settings_); // read where a solver is made
    const Cloth& cloth = simulation_.cloth();
    EdgeSet rows(cloth, options_);
    std::vector<Vec3> x = simulation_.state().positions;
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += step_of(side_) * simulation_.state().velocities[i];
    Candidate candidate;
    candidate.multipliers.force_density.assign(cloth.mesh.edges.size(), 0.0);
    SolveReport report = solve(rows, x, candidate); // what is done once, an analysis, is not measured
    for (auto _ : state) report = solve(rows, x, candidate);
    state.counters["iterations_of_solver"] = report.iterations;
    if (!report.failure.empty()) state.SkipWithError(report.failure.c_str());
  }

private:
  SolveReport solve(EdgeSet& rows, std::span<const Vec3> x, const Candidate& candidate) const {
    Freedom freedom(simulation_.state().positions.size());
    const std::vector<Global>& original = simulation_.cloth().mesh.vertices.original;
    for (Local v = 0; v < Local(original.size()); ++v)
      if (original[v] == 0 || original[v] == side_ - 1) freedom.hold(v);
    rows.start(simulation_.state(), step_of(side_), freedom, candidate);
    rows.evaluate(x);
    return rows.solve(1e-6);
  }

  const Simulation& simulation_;
  int side_;
  config::Inextensibility options_;
  std::vector<test::PetscSetting> settings_;
};

void measure_yarns(const Simulation& simulation) {
  const Cloth& cloth = simulation.cloth();
  auto constraints = std::make_shared<EdgeConstraints>(cloth, simulation.inextensibility());
  constraints->start(0.005, Freedom(cloth.mesh.vertices.size()));
  constraints->evaluate(simulation.state().positions);
  auto system = std::make_shared<ProjectionSystem>(cloth.mesh, SolverOptions{});
  const auto assemble = [constraints, system] {
    system->assemble(constraints->gradients(), constraints->inverse_mass(), constraints->scaled_compliance());
  };
  assemble();
  measure("projection_assembly", 0, assemble);
  auto yarns = std::make_shared<YarnSystem>(cloth.mesh);
  yarns->factor(constraints->gradients(), constraints->inverse_mass(), Freedom(cloth.mesh.vertices.size()),
                constraints->scaled_compliance());
  auto b = std::make_shared<std::vector<double>>(cloth.mesh.edges.owned, 1.0), x = b;
  x = std::make_shared<std::vector<double>>(*b);
  // Forth: b, L and x; back: x, L, 1/D and x again.
  measure("yarn_apply", 56.0 * cloth.mesh.edges.owned, [yarns, b, x] { yarns->solve(*b, *x); });
}

void measure_projections(const Simulation& simulation, int side) {
  using enum config::LinearSolver;
  const auto block = [](std::vector<test::PetscSetting> inner) {
    std::vector<test::PetscSetting> all{{"-projection_pc_type", "bjacobi"}}; // one rank: one block
    for (auto& [name, value] : inner) all.push_back({"-projection_sub_" + name, value});
    return all;
  };
  const auto add = [&](const char* name, config::LinearSolver solver,
                       std::vector<test::PetscSetting> settings) {
    benchmark::RegisterBenchmark(name, Projection(simulation, side, solver, std::move(settings)))
        ->Unit(benchmark::kMillisecond);
  };
  add("solve_yarn", cg, {});
  add("solve_icc", cg, block({{"pc_type", "icc"}}));
  add("solve_boomeramg", cg,
      {{"-projection_pc_type", "hypre"},
       {"-projection_pc_hypre_type", "boomeramg"},
       {"-projection_pc_hypre_boomeramg_strong_threshold", "0.9"}});
  add("solve_cholmod", cg, block({{"pc_type", "cholesky"}, {"pc_factor_mat_solver_type", "cholmod"}}));
  add("solve_mumps", mumps, {});
}

} // namespace

int main(int argc, char** argv) {
  const int side = argc > 1 ? std::atoi(argv[1]) : 0;
  if (side < 3) {
    std::fputs("usage: kernels SIDE [options of Google Benchmark]; SIDE is at least 3\n", stderr);
    return 2;
  }
  argv[1] = argv[0];
  int rest = argc - 1;
  char** words = argv + 1;
  benchmark::Initialize(&rest, words);
  const Session session(argc, argv, {});
  const Case input = falling_cloth(side);
  Simulation simulation(MPI_COMM_WORLD, input);
  if (!let_fall(simulation, side)) {
    std::fputs("kernels: the cloth could not be simulated\n", stderr);
    return 1;
  }
  auto velocity = std::make_shared<Velocity>(simulation);
  measure_bandwidth();
  measure("velocity_assembly", 0, [velocity] { velocity->assemble(); });
  measure("velocity_product", velocity->bytes(), [velocity] { velocity->multiply(); });
  measure_yarns(simulation);
  measure_projections(simulation, side);
  benchmark::RunSpecifiedBenchmarks();
  benchmark::ClearRegisteredBenchmarks(); // what they hold must go before PETSc does
}
