#pragma once
#include "src/time/simulation.hpp"

/// Where a run ends that has a goal: when its seams are closed, or when nothing moves any more. All
/// collective.
namespace taut::command {

bool has_arrived(const Case& input, const Simulation& simulation);

/// Of a run that was to close seams: failed if one is open, naming it.
Outcome judge_seams(const Case& input, const Simulation& simulation);

} // namespace taut::command
