#pragma once
#include "src/config/case.hpp"
#include "src/output/progress.hpp"
#include "src/time/simulation.hpp"

#include <mpi.h>

#include <filesystem>
#include <vector>

/// What `taut <command>` does. Each returns the program's exit code; all are collective, and rank 0 speaks.
namespace taut::command {

enum ExitCode { success = 0, internal_error = 1, input_error = 2, step_failure = 3, interrupted = 4 };

/// What commands are told about a case.
struct CaseSource {
  std::filesystem::path file;
  std::vector<Override> overrides;
  std::vector<std::string> petsc{}; ///< words of PETSc options, beside those of the case
};

enum class ExistingRun { refuse, overwrite };

struct RunOptions {
  CaseSource source;
  std::filesystem::path out; ///< empty: out/<name of the case>
  ExistingRun existing = ExistingRun::refuse;
  ProgressStyle progress = ProgressStyle::lines;
  std::filesystem::path from{};   ///< a run whose mesh and last frame take the place of those of the cloth
  std::filesystem::path counters; ///< where to write what the phases said between ranks; empty: nowhere
};

struct ResumeOptions {
  std::filesystem::path folder; ///< of the run
  std::vector<Override> overrides;
  std::vector<std::string> petsc;   ///< as in CaseSource
  std::filesystem::path checkpoint; ///< empty: the latest that is whole
  ProgressStyle progress = ProgressStyle::lines;
};

/// `thorough` also does what may take as long as a run.
enum class CheckDepth { quick, thorough };

struct CheckOptions {
  CaseSource source;
  CheckDepth depth = CheckDepth::quick;
};

struct PartitionOptions {
  CaseSource source;
  int ranks = 1;              ///< to cut the cloth for; any number of ranks can do it
  std::filesystem::path json; ///< empty: none
};

struct MeshOptions {
  std::filesystem::path pattern;
  std::vector<std::string> edges; ///< lengths of the edges: "5mm", and of single panels "collar=2mm"
  std::filesystem::path out, svg; ///< empty: none
};

struct ExportOptions {
  std::filesystem::path folder; ///< of the run
  std::filesystem::path to;     ///< .pc2 (and beside it the mesh, .obj), .obj, .ply or .usda
  std::string up = "z", unit = "m";
  std::optional<Global> frame{}; ///< absent: all; of .usda the last
};

int run(MPI_Comm comm, const RunOptions& options);
int resume(MPI_Comm comm, const ResumeOptions& options);
int check(MPI_Comm comm, const CheckOptions& options);

/// Verifies the checksums of all that a run wrote in HDF5.
int check_run(MPI_Comm comm, const std::filesystem::path& folder);

/// Of a case, or of a folder with a run, which takes no overrides. Of a case a first step is tried.
int info(MPI_Comm comm, const CaseSource& source);
int partition(MPI_Comm comm, const PartitionOptions& options);
int mesh(MPI_Comm comm, const MeshOptions& options);
int export_frames(MPI_Comm comm, const ExportOptions& options);

/// Reads the case file on rank 0 and shares it; its PETSc options, with those given, are in force then.
/// Throws InputError. Collective.
Case load_case(MPI_Comm comm, const CaseSource& source);

/// If there are PETSc options, tries a step that is thrown away; throws InputError if PETSc was given options
/// that it refuses or that no solver asked for.
void try_petsc_options(Simulation& simulation, const Case& input, std::span<const std::string> given);

} // namespace taut::command
