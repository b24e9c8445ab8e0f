#pragma once
#include "partition/types.hpp"

#include <array>
#include <span>
#include <vector>

namespace taut {

/// For each vertex of a mesh the way (m) by which it gives way so that parts of the body that face each
/// other, as in an armpit or between thighs, leave about `room` (m) between them. The ball that touches the
/// surface at a vertex from outside has the radius R = min |p − q|² / (2 (q − p)·n) over the other vertices q
/// [Ma, Bae, Choi 2012]; where 2 R < room the vertex moves inwards by what is missing of room/2, at most by
/// half of what is behind it. Only within `room` of vertices that face others, with normals apart by more
/// than 100 degrees, of parts as thick as `room`: cloth lies over a crease that is wider, as between neck and
/// shoulders, and does not enter what is small, as ears.
std::vector<Vec3> ways_to_room(std::span<const Vec3> positions,
                               std::span<const std::array<Local, 3>> triangles, double room);

} // namespace taut
