#include "src/linear/session.hpp"

#include "partition/comm.hpp"
#include "src/linear/petsc.hpp"
#include "src/linear/unassembled.hpp"
#include "src/linear/yarn_preconditioner.hpp"

#include <fmt/ranges.h>

#include <set>
#include <sstream>
#include <vector>

namespace taut {

Session::Session(int& argc, char**& argv, std::span<const std::string> petsc_options) {
  int is_started = 0;
  MPI_Initialized(&is_started);
  if (is_started == 0) MPI_Init(&argc, &argv);
  owns_mpi_ = is_started == 0;
  MPI_Comm_set_errhandler(MPI_COMM_WORLD, MPI_ERRORS_ARE_FATAL);
  std::vector<char*> options{argv[0]};
  std::vector<std::string> kept(petsc_options.begin(), petsc_options.end());
  for (std::string& o : kept) options.push_back(o.data());
  options.push_back(nullptr);
  int count = int(options.size()) - 1;
  char** first = options.data();
  check(PetscInitialize(&count, &first, nullptr, nullptr));
  check(PetscPopSignalHandler());
  check(PetscPushErrorHandler(PetscReturnErrorHandler, nullptr));
  check(PetscOptionsSetValue(nullptr, "-options_left", "no")); // unused_petsc_options reports them
  register_yarn_preconditioner();
  register_velocity_preconditioners();
}

Session::~Session() {
  PetscFinalize();
  if (owns_mpi_) MPI_Finalize();
}

namespace {

/// Names without their dash, of options that this rank has not asked for.
std::set<std::string> unused_here() {
  PetscInt count = 0;
  char **names = nullptr, **values = nullptr;
  check(PetscOptionsLeftGet(nullptr, &count, &names, &values));
  std::set<std::string> unused(names, names + count);
  check(PetscOptionsLeftRestore(nullptr, &count, &names, &values));
  unused.erase("options_left");
  return unused;
}

} // namespace

void add_petsc_options(const std::string& options) {
  check(PetscOptionsInsertString(nullptr, options.c_str()));
}

std::string unused_petsc_options(MPI_Comm comm) {
  const std::set<std::string> here = unused_here();
  std::istringstream of_rank_0(broadcast_text(comm, fmt::format("{}", fmt::join(here, "\n"))));
  std::string unused;
  for (std::string name; std::getline(of_rank_0, name);)
    if (!any_of(comm, !here.contains(name))) unused += (unused.empty() ? "-" : " -") + name;
  return unused;
}

} // namespace taut
