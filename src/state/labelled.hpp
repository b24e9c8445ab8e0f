#pragma once
#include "src/state/cloth.hpp"

#include <span>
#include <string>
#include <vector>

namespace taut {

/// The vertices with a label, of these cloths together, in the numbers of all; `key` names it in the
/// InputError if there are none.
std::vector<Global> labelled(std::span<const Piece> pieces, const std::string& label, const std::string& key);

} // namespace taut
