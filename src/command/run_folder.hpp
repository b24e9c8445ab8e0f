#pragma once
#include "src/command/command.hpp"

/// The folder that holds a run. All collective; what cannot be done is an InputError.
namespace taut::command {

/// Makes the folder `out`, if it is not there.
void make_run_folder(MPI_Comm comm, const std::filesystem::path& out, const std::filesystem::path& case_file);

/// Makes the folder, of which this program holds the lock, ready for a new run.
void clear_run_folder(MPI_Comm comm, const std::filesystem::path& out, ExistingRun existing);

/// Removes what comes after the step of a checkpoint: frames from `next_frame` on, later checkpoints, the
/// summary. What a run was writing when it was cut off goes too.
void drop_after(MPI_Comm comm, const std::filesystem::path& out, Global step, Global next_frame);

} // namespace taut::command
