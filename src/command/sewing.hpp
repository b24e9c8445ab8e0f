#pragma once
#include "src/command/simulate.hpp"

/// A case with the key `sewing` is run in three stages, each with a folder of its own:
///
/// 1. OUT/sewing: panels are drawn together at their seams around bodies that are slim; it ends with the
///    garment as one mesh.
/// 2. OUT/fitting: bodies grow to their size in the garment. Without obstacles there is no such stage.
/// 3. OUT: the case itself begins with that garment.
namespace taut::command {

enum class SewingStage { sewing, fitting };

/// The folder of a stage.
std::filesystem::path folder_of(SewingStage stage, const std::filesystem::path& out);

/// The case of a stage: in a vacuum, without friction; pins and obstacles as at time 0.
Case case_of(SewingStage stage, const Case& input, const std::filesystem::path& out);

/// With all that the case leaves open, and every garment where its seams pass the bodies; `unsewn` is the
/// case at its start. Throws InputError where they are not together. Collective.
Case ready_to_sew(const Simulation& unsewn, Case input);

/// Makes the start of a stage sound: panels must be, as they are placed; what the weld of a garment took
/// through something or strained is fixed. False if it cannot be, which is told. Collective.
bool clear_stage(SewingStage stage, Simulation& simulation, const Case& input,
                 const std::filesystem::path& out);

/// Begins with the first stage, and goes on to the others.
int run_sewing(MPI_Comm comm, const Case& input, const RunOptions& options, const StopSignal& stop,
               double began);

/// All that comes after a stage that has ended as `ended`. This program holds the lock of the folder.
/// Collective.
int run_after(SewingStage stage, MPI_Comm comm, const Case& input, const Simulation& ended,
              const RunOptions& options, const StopSignal& stop, double began);

/// The file that holds the mesh of a cloth in a folder: STEM.h5, or of several cloths STEM_1.h5.
std::filesystem::path garment_file(const Case& input, std::size_t k, const std::filesystem::path& folder,
                                   const std::string& stem);

/// The case with the bodies that stayed back in the fitting of a run as they were then, if there are such.
/// Collective.
Case with_fitted_bodies(MPI_Comm comm, Case input, const std::filesystem::path& run);

/// Runs the case with these meshes, one a cloth, in the place of its patterns: once what overlaps is
/// untangled and what is strained is relaxed. This program holds the lock of the folder. Collective.
int run_garments(MPI_Comm comm, Case input, std::span<const std::filesystem::path> meshes,
                 const RunOptions& options, const StopSignal& stop, double began);

} // namespace taut::command
