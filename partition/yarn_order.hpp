#pragma once
#include "partition/types.hpp"

#include <array>
#include <span>
#include <vector>

namespace taut {

/// Edges in an order in which those of one yarn follow each other from end to end. `edges` are given by their
/// vertices; `triples` say which two edges continue one another (triples about other edges are passed over).
/// Yarns come in the order of their first edge; a closed yarn is cut open at the first vertex of that edge.
/// Not collective.
std::vector<Local> order_by_yarn(std::span<const std::array<Local, 2>> edges,
                                 std::span<const std::array<Local, 3>> triples);

} // namespace taut
