#pragma once
#include "src/command/simulate.hpp"

/// A garment that begins as another run left it (cloth.start.run): its pattern, meshed anew with edges of
/// another length, carried there by the coordinates of the pattern. There is nothing left to sew.
namespace taut::command {

/// The last frame of a run. Collective; throws InputError, beginning with `key`, if there is none.
std::filesystem::path last_frame(MPI_Comm comm, const std::filesystem::path& run, const std::string& key);

/// Whether a cloth of the case begins so.
bool is_carried(const Case& input);

/// Makes the start, frees it of intersections and runs the case.
int run_carried(MPI_Comm comm, const Case& input, const RunOptions& options, const StopSignal& stop,
                double began);

} // namespace taut::command
