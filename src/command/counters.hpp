#pragma once
#include "src/output/totals.hpp"

#include <string>

namespace taut::command {

/// What the phases of a run said between ranks, as JSON, the same on every rank: of each count the sum, the
/// mean and the largest over the ranks, and how uneven the work is. Collective.
std::string counters_text(MPI_Comm comm, const Totals& totals, Global rejected_steps);

} // namespace taut::command
