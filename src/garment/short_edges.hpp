#pragma once
#include "src/garment/sample_outlines.hpp"

#include <vector>

namespace taut::garment {

/// Of each panel, of each edge: whether the mesh draws it to a point.
using ShortEdges = std::vector<std::vector<char>>;

/// The edges that are much shorter than those of the mesh are to be, with what they are sewn to: less than a
/// quarter. Cutters leave edges of a millimetre where a dart of one panel meets that of another. A mesh that
/// kept them would have cells of that size, and its steps would be as short as these need. No two that are
/// drawn to a point meet, and no panel keeps less than three edges.
ShortEdges find_short_edges(const SewingPattern& pattern, const EdgeLengths& lengths);

} // namespace taut::garment
