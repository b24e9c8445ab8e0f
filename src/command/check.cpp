#include "src/command/command.hpp"
#include "src/command/sewing.hpp"
#include "src/command/start_contact.hpp"
#include "src/command/warnings.hpp"
#include "src/time/simulation.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <optional>

namespace taut::command {

namespace {

/// To untangle a start can take as long as a run.
bool is_quick(const Case& input) {
  return input.contact.value_or(config::Contact{}).start == config::StartContact::refuse;
}

} // namespace

int check(MPI_Comm comm, const CheckOptions& options) {
  const CaseSource& source = options.source;
  const Case input = load_case(comm, source);
  Simulation simulation(comm, input);
  warn_of_start(simulation, input);
  std::optional<Simulation> sewing;
  if (input.sewing) sewing.emplace(comm, case_of(SewingStage::sewing, ready_to_sew(simulation, input), {}));
  Simulation& first = sewing ? *sewing : simulation;
  if (options.depth == CheckDepth::thorough || is_quick(input)) {
    if (!clear_start(first, input, std::filesystem::path("out") / (input.name + ".findings.vtp")))
      return step_failure;
  } else if (rank_of(comm) == 0) {
    fmt::print("{}: whether the start can be untangled is tried with --thorough\n", source.file.string());
  }
  first.trial_step();
  try_petsc_options(first, input, source.petsc);
  const DistributedMesh& mesh = simulation.cloth().mesh;
  if (rank_of(comm) == 0)
    fmt::print(
        "{}: the case is sound: {} vertices, {} cells, {} constrained edges, {} pinned vertices, {} frames\n",
        source.file.string(), mesh.vertices.total, mesh.total_cells, mesh.edges.total,
        simulation.pins().count(), simulation.step_size().frames());
  return success;
}

} // namespace taut::command
