#include "src/command/command.hpp"
#include "src/time/simulation.hpp"

#include <fmt/format.h>

#include <cstdio>

namespace taut::command {

int check(MPI_Comm comm, const CaseSource& source) {
  const Case input = load_case(comm, source);
  Simulation simulation(comm, input);
  simulation.trial_step();
  try_petsc_options(simulation, input, source.petsc);
  const DistributedMesh& mesh = simulation.cloth().mesh;
  if (rank_of(comm) == 0)
    fmt::print(
        "{}: the case is sound: {} vertices, {} cells, {} constrained edges, {} pinned vertices, {} frames\n",
        source.file.string(), mesh.vertices.total, mesh.total_cells, mesh.edges.total,
        simulation.pins().count(), simulation.step_size().frames());
  return success;
}

} // namespace taut::command
