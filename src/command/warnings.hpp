#pragma once
#include "src/time/simulation.hpp"

namespace taut::command {

/// Says on standard error what is allowed but seldom meant: cloth out of all scale, heavier or lighter than
/// any fabric, wholly inside a solid, torn from its place at the start; meshes that lock. Rank 0 speaks. The
/// present state is the start. Collective.
void warn_of_start(const Simulation& simulation, const Case& input);

} // namespace taut::command
