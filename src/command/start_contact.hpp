#pragma once
#include "src/time/simulation.hpp"

#include <filesystem>

namespace taut::command {

/// Looks whether the cloth intersects something where it starts, and does with it what `contact.start` says.
/// Whether the run can begin; if not, rank 0 has said why. What intersects goes to `file`. Throws InputError
/// for a start that is refused. Collective.
bool clear_start(Simulation& simulation, const Case& input, const std::filesystem::path& file);

/// The same, and then relaxes a start that is strained beyond its limit (Simulation::relax), and says so.
/// Whether the run can begin; if not, rank 0 has said why. Collective.
bool prepare_start(Simulation& simulation, const Case& input, const std::filesystem::path& file);

} // namespace taut::command
