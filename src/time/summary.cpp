#include "src/time/summary.hpp"

#include "src/config/methods.hpp"

#include <nlohmann/json.hpp>

#include <sys/resource.h>

#include <cmath>

namespace taut {

namespace {

constexpr int bins = 1000;

/// Largest resident size so far, bytes.
double peak_memory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return 1024.0 * double(usage.ru_maxrss);
}

const char* method_name(config::InextensibilityMethod method) {
  return config::words_of(method)[std::size_t(method)].data();
}

} // namespace

Summary::Summary(const Simulation& simulation, const Case& input, double setup_seconds)
    : simulation_(simulation), input_(input), setup_seconds_(setup_seconds), began_(MPI_Wtime()),
      histogram_(bins + 1, 0.0) {}

void Summary::after_step(const State& state, const StepRecord& r) {
  ++steps_;
  iterations_ += r.iterations;
  linear_iterations_ += r.linear_iterations;
  velocity_iterations_ += r.velocity_iterations;
  iterations_max_ = std::max(iterations_max_, r.iterations);
  contacts_max_ = std::max(contacts_max_, r.contacts);
  strain_max_ = std::max(strain_max_, r.strain.max);
  strain_squares_ += r.strain.rms * r.strain.rms;
  seconds_ += r.seconds;
  const Cloth& cloth = simulation_.cloth();
  for (Local e = 0; e < cloth.mesh.edges.owned; ++e) {
    const double bin =
        std::ceil(std::abs(strain_of(cloth, state.positions, e)) / input_.inextensibility.strain * bins);
    ++histogram_[bin < bins ? int(bin) : bins];
  }
}

/// The strain that `fraction` of all edges in all steps do not exceed, to 1/1000 of the limit; no more than
/// the maximum.
double Summary::quantile(double fraction) const {
  std::vector<double> count(histogram_);
  sum_in_place(simulation_.cloth().mesh.comm, count);
  double all = 0, below = 0;
  for (const double c : count) all += c;
  for (int b = 0; b < bins; ++b) {
    below += count[b];
    if (below >= fraction * all) return std::min(strain_max_, input_.inextensibility.strain * b / bins);
  }
  return strain_max_;
}

std::string Summary::text(const Outcome& outcome, Global frames, Global intersections,
                          double output_seconds) const {
  using Json = nlohmann::ordered_json;
  const DistributedMesh& mesh = simulation_.cloth().mesh;
  const auto a_step = [this](double total) { return steps_ > 0 ? total / double(steps_) : 0.0; };
  const double memory = peak_memory(), memory_max = max_over(mesh.comm, memory),
               memory_sum = sum_over(mesh.comm, memory);
  const Json json = {
      {"status", outcome.completed ? "completed" : "failed"},
      {"reason", outcome.reason},
      {"case", input_.name},
      {"version", TAUT_VERSION},
      {"ranks", size_of(mesh.comm)},
      {"vertices", mesh.vertices.total},
      {"faces", mesh.total_cells},
      {"constraints", mesh.edges.total},
      {"frames", frames},
      {"steps", steps_},
      {"rejected_steps", outcome.rejected_steps},
      {"end_time", simulation_.state().time},
      {"strain",
       {{"limit", config::holds_limit(input_.inextensibility) ? Json(input_.inextensibility.strain) : Json()},
        {"max", strain_max_},
        {"rms", std::sqrt(a_step(strain_squares_))},
        {"p999", quantile(0.999)}}},
      {"projection",
       {{"method", method_name(input_.inextensibility.method)},
        {"iterations_mean", a_step(double(iterations_))},
        {"iterations_max", iterations_max_},
        {"ksp_iterations_mean", iterations_ > 0 ? double(linear_iterations_) / double(iterations_) : 0.0}}},
      {"velocity", {{"ksp_iterations_mean", a_step(double(velocity_iterations_))}}},
      {"contact", {{"pairs_max", contacts_max_}, {"intersections", intersections}}},
      {"partition",
       {{"edge_cut", mesh.report.edge_cut},
        {"imbalance", mesh.report.imbalance},
        {"ghosts_max", mesh.report.ghosts_max}}},
      {"seconds",
       {{"total", setup_seconds_ + MPI_Wtime() - began_},
        {"setup", setup_seconds_},
        {"velocity", seconds_.velocity},
        {"projection", seconds_.projection},
        {"contact", seconds_.contact},
        {"output", output_seconds}}},
      {"memory_bytes", {{"max_rank", Global(memory_max)}, {"sum", Global(memory_sum)}}}};
  return json.dump(2) + "\n";
}

} // namespace taut
