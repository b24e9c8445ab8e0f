#pragma once
#include "io/obj_parser.hpp"

namespace taut {

/// A PLY file (ascii, or binary of either byte order): the x, y, z of its vertices and the lists
/// vertex_indices (or vertex_index) of its faces, of 3 or 4 corners; other elements and properties are passed
/// over. Lines are not told. Not collective. Throws `InputError` "`name`: what is wrong; cure".
ObjFile parse_ply(std::string_view text, const std::string& name);

} // namespace taut
