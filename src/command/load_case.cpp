#include "src/command/command.hpp"
#include "src/command/petsc_options.hpp"
#include "src/linear/session.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>

namespace taut::command {

Case load_case(MPI_Comm comm, const CaseSource& source) {
  const std::string file = source.file.string();
  const std::string text = broadcast(comm, [&] {
    if (std::filesystem::is_directory(source.file))
      throw InputError(
          fmt::format("{0}: this is a folder; name the case file in it, e.g. {0}/case.yaml", file));
    std::ifstream in(source.file);
    if (!in) throw InputError(fmt::format("{}: cannot be read: {}", file, std::strerror(errno)));
    std::ostringstream all;
    all << in.rdbuf();
    return all.str();
  });
  Case input = read_case(text, file, source.overrides);
  input.petsc = merged_petsc_options(input.petsc, options_of_environment());
  input.petsc = merged_petsc_options(input.petsc, source.petsc);
  add_petsc_options(input.petsc);
  return input;
}

void try_petsc_options(Simulation& simulation, const Case& input, std::span<const std::string> given) {
  if (input.petsc.empty() && given.empty()) return;
  simulation.trial_step();
  const std::string unused = unused_petsc_options(simulation.cloth().mesh.comm);
  if (unused.empty()) return;
  if (input.inextensibility.method == config::InextensibilityMethod::newton)
    throw InputError(
        fmt::format("PETSc option {}: method newton has no linear solver of PETSc but that of "
                    "inextensibility.solver: mumps (-kkt_); remove it, or choose inextensibility.method: "
                    "fast_projection",
                    unused));
  throw InputError(fmt::format(
      "PETSc option {}: no solver of this case knows it; options start with -velocity_ or "
      "-projection_ (e.g. -projection_ksp_monitor), those of methods icd and sap also with -kkt_ or "
      "-stiffness_",
      unused));
}

} // namespace taut::command
