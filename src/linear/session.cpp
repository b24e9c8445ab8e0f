#include "src/linear/session.hpp"

#include "src/linear/petsc.hpp"
#include "src/linear/unassembled.hpp"
#include "src/linear/yarn_preconditioner.hpp"

#include <vector>

namespace taut {

Session::Session(int& argc, char**& argv, std::span<const std::string> petsc_options) {
  MPI_Init(&argc, &argv);
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
  register_axis_preconditioner();
}

Session::~Session() {
  PetscFinalize();
  MPI_Finalize();
}

std::string unused_petsc_options() {
  PetscInt count = 0;
  char **names = nullptr, **values = nullptr;
  check(PetscOptionsLeftGet(nullptr, &count, &names, &values));
  std::string unused;
  for (PetscInt i = 0; i < count; ++i)
    if (std::string(names[i]) != "options_left")
      unused += (unused.empty() ? "-" : " -") + std::string(names[i]);
  check(PetscOptionsLeftRestore(nullptr, &count, &names, &values));
  return unused;
}

} // namespace taut
