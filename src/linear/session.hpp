#pragma once
#include <mpi.h>

#include <span>
#include <string>

namespace taut {

/// Starts PETSc, and MPI if nobody did; ends what it started when it goes. One a program. PETSc's options
/// come from `petsc_options` alone (`{"-velocity_ksp_monitor", ...}`) and from the environment variable
/// PETSC_OPTIONS, never from the command line. PETSc's signal handlers and error printing stay off.
class Session {
public:
  Session(int& argc, char**& argv, std::span<const std::string> petsc_options);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

private:
  bool owns_mpi_;
};

/// Adds options, separated by spaces, to those that are given, or puts them in their place. Not collective,
/// but the same on all ranks.
void add_petsc_options(const std::string& options);

/// The options given but asked for by no rank so far, e.g. because they are misspelt; the same text on every
/// rank. A solver on some of the ranks (PCTELESCOPE, coarse grids) asks for its options there alone.
/// Collective.
std::string unused_petsc_options(MPI_Comm comm);

} // namespace taut
