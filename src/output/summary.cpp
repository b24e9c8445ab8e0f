#include "src/output/summary.hpp"

#include "src/config/cloths.hpp"
#include "src/config/methods.hpp"
#include "src/output/memory.hpp"

#include <nlohmann/json.hpp>

#include <cmath>

namespace taut {

namespace {

constexpr int bins = 1000;

const char* method_name(config::InextensibilityMethod method) { return config::word_of(method).data(); }

/// The histogram under another limit: each bin goes where its upper end lies.
std::vector<double> rescaled(const std::vector<double>& histogram, double factor) {
  std::vector<double> result(bins + 1, 0.0);
  for (std::size_t b = 0; b < histogram.size(); ++b)
    result[std::min<std::size_t>(bins, std::size_t(std::ceil(double(b) * factor)))] += histogram[b];
  return result;
}

/// The strain that `fraction` of all edges in all steps do not exceed, to 1/1000 of the limit; no more than
/// the maximum. Collective.
double quantile(MPI_Comm comm, const Totals& totals, double fraction) {
  std::vector<double> count(totals.histogram);
  sum_in_place(comm, count);
  double all = 0, below = 0;
  for (const double c : count) all += c;
  for (int b = 0; b < bins; ++b) {
    below += count[b];
    if (below >= fraction * all) return std::min(totals.strain_max, totals.strain_limit * b / bins);
  }
  return totals.strain_max;
}

const char* status_of(Ending ending) {
  switch (ending) {
  case Ending::completed:
    return "completed";
  case Ending::interrupted:
    return "interrupted";
  case Ending::failed:
    return "failed";
  }
  return "";
}

} // namespace

Summary::Summary(const Simulation& simulation, const Case& input, const IntersectionCheck& intersections,
                 Totals earlier, double began)
    : simulation_(simulation), input_(input), intersections_(intersections), totals_(std::move(earlier)),
      began_(began) {
  const double limit = input.inextensibility.strain;
  totals_.setup_seconds += MPI_Wtime() - began;
  totals_.histogram =
      rescaled(totals_.histogram, totals_.strain_limit == limit ? 1.0 : totals_.strain_limit / limit);
  totals_.strain_limit = limit;
}

void Summary::after_step(const State& state, const StepRecord& r) {
  Totals& t = totals_;
  ++t.steps;
  t.counts += r.counts;
  t.iterations_max = std::max(t.iterations_max, r.counts.iterations);
  t.contacts_max = std::max(t.contacts_max, r.counts.contacts);
  t.residual_max = std::max(t.residual_max, r.residual);
  t.strain_max = std::max(t.strain_max, r.strain.max);
  t.edge_strain_max = std::max(t.edge_strain_max, r.strain.of_edges);
  t.average_strain_max = std::max(t.average_strain_max, r.strain.of_averages);
  t.face_strain_max = std::max(t.face_strain_max, r.face_strain);
  t.strain_squares += r.strain.rms * r.strain.rms;
  simulation_.gauge().for_each(state.positions, [&](double strain, std::span<const Local>) {
    const double bin = std::ceil(std::abs(strain) / t.strain_limit * bins);
    ++t.histogram[bin < bins ? int(bin) : bins];
  });
}

Totals Summary::totals(double output_seconds) const {
  Totals totals = totals_;
  totals.intersections += intersections_.count();
  totals.seconds += MPI_Wtime() - began_;
  totals.output_seconds += output_seconds;
  return totals;
}

namespace {

using Json = nlohmann::ordered_json;

Json cloths_of(const Cloth& cloth, const Case& input) {
  Json cloths = Json::array();
  for (std::size_t k = 0; k < cloth.pieces.size(); ++k) {
    const Piece& piece = cloth.pieces[k];
    cloths.push_back(
        {{"name", config::name_of_cloth(input, k)}, {"vertices", piece.vertices}, {"faces", piece.cells}});
  }
  return cloths;
}

Json projection_of(const config::Inextensibility& limits, const Totals& all) {
  const bool is_newton = limits.method == config::InextensibilityMethod::newton;
  const double steps = std::max(1.0, double(all.steps)), iterations = double(all.counts.iterations);
  return {{"method", method_name(limits.method)},
          {"compliance", config::is_projection(limits.method) ? Json(*limits.compliance) : Json()},
          {"iterations_mean", iterations / steps},
          {"iterations_max", all.iterations_max},
          {"ksp_iterations_mean", iterations > 0 ? double(all.counts.linear_iterations) / iterations : 0.0},
          {"residual_max", is_newton ? Json(all.residual_max) : Json()}};
}

Json seconds_of(const Totals& all) {
  return {{"total", all.seconds},
          {"setup", all.setup_seconds},
          {"velocity", all.counts.velocity_seconds},
          {"projection", all.counts.projection_seconds},
          {"contact", all.counts.contact_seconds},
          {"cpu", all.counts.cpu_seconds},
          {"output", all.output_seconds}};
}

} // namespace

std::string Summary::text(const Outcome& outcome, Global frames, double output_seconds) const {
  const DistributedMesh& mesh = simulation_.cloth().mesh;
  const Totals all = totals(output_seconds);
  const config::Inextensibility& limits = simulation_.inextensibility();
  const auto a_step = [&](double total) { return all.steps > 0 ? total / double(all.steps) : 0.0; };
  const double memory = peak_memory(), memory_max = max_over(mesh.comm, memory),
               memory_sum = sum_over(mesh.comm, memory);
  const Json json = {
      {"status", status_of(outcome.ending)},
      {"reason", outcome.reason},
      {"case", input_.name},
      {"version", TAUT_VERSION},
      {"ranks", size_of(mesh.comm)},
      {"vertices", mesh.vertices.total},
      {"faces", mesh.total_cells},
      {"constraints", mesh.edges.total},
      {"cloths", cloths_of(simulation_.cloth(), input_)},
      {"frames", frames},
      {"steps", all.steps},
      {"rejected_steps", simulation_.rejected_steps()},
      {"end_time", simulation_.state().time},
      {"strain",
       {{"limit", simulation_.strain_limit() ? Json(*simulation_.strain_limit()) : Json()},
        {"max", all.strain_max},
        {"rms", std::sqrt(a_step(all.strain_squares))},
        {"of", config::word_of(*limits.constrain)},
        {"edges_max", all.edge_strain_max},
        {"averages_max", all.average_strain_max},
        {"faces_limit", simulation_.faces_limit() ? Json(*simulation_.faces_limit()) : Json()},
        {"faces_max", limits.constrain == config::Constrain::vertices ? Json(all.face_strain_max) : Json()},
        {"p999", quantile(mesh.comm, all, 0.999)}}},
      {"projection", projection_of(limits, all)},
      {"velocity", {{"ksp_iterations_mean", a_step(double(all.counts.velocity_iterations))}}},
      {"contact",
       {{"pairs_max", all.contacts_max},
        {"imbalance",
         all.counts.contacts > 0 ? double(all.counts.contacts_if_even) / double(all.counts.contacts) : 1.0},
        {"across",
         all.counts.contacts > 0 ? double(all.counts.contacts_across) / double(all.counts.contacts) : 0.0},
        {"gap_min", std::isfinite(all.counts.smallest_gap) ? Json(all.counts.smallest_gap) : Json()},
        {"intersections", all.intersections}}},
      {"partition",
       {{"edge_cut", mesh.report.edge_cut},
        {"imbalance", mesh.report.imbalance},
        {"ghosts_max", mesh.report.ghosts_max}}},
      {"seconds", seconds_of(all)},
      {"memory_bytes", {{"max_rank", Global(memory_max)}, {"sum", Global(memory_sum)}}}};
  return json.dump(2) + "\n";
}

} // namespace taut
