#pragma once
#include "io/obj_parser.hpp"

namespace taut {

/// An STL file, binary or ascii: triangles whose corners are one vertex where their coordinates are the same.
/// Triangles without area by that are left out. Lines are not told. Not collective. Throws `InputError`
/// "`name`: what is wrong; cure".
ObjFile parse_stl(std::string_view text, const std::string& name);

} // namespace taut
