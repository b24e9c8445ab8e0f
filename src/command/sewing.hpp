#pragma once
#include "src/command/simulate.hpp"

/// A case with the key `sewing` is run in two stages, each with a folder of its own: that in which the panels
/// are sewn, OUT/sewing, which ends with the garment as one mesh, and that of the case itself, OUT, which
/// begins with it.
namespace taut::command {

/// The folder of the first stage.
std::filesystem::path sewing_folder(const std::filesystem::path& out);

/// The case of the first stage: panels on their way, in a vacuum, without friction; pins and obstacles as at
/// time 0.
Case sewing_stage(Case input);

/// Begins and ends the first stage; goes on with the second.
int run_sewing(MPI_Comm comm, const Case& input, const RunOptions& options, const StopSignal& stop,
               double began);

/// The second, after the first has closed all seams: makes the cloth one mesh, and runs it. This program
/// holds the lock of the folder. Collective.
int run_sewn(MPI_Comm comm, const Case& input, const Simulation& sewn, const RunOptions& options,
             const StopSignal& stop, double began);

/// The file that holds the mesh of a cloth in a folder: sewn.h5, or of several cloths sewn_1.h5.
std::filesystem::path garment_file(const Case& input, std::size_t k, const std::filesystem::path& folder,
                                   const std::string& stem);

/// Runs the case with these meshes, one a cloth, in the place of its patterns: once what overlaps is
/// untangled and what is strained is relaxed. This program holds the lock of the folder. Collective.
int run_garments(MPI_Comm comm, const Case& input, std::span<const std::filesystem::path> meshes,
                 const RunOptions& options, const StopSignal& stop, double began);

} // namespace taut::command
