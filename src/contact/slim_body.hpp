#pragma once
#include "partition/types.hpp"

#include <mpi.h>

#include <array>
#include <span>
#include <vector>

namespace taut {

/// For each vertex of a mesh the way (m) to where it lies when the body is slim: a limb close to its axis, a
/// trunk close to its middle, as long as they were. In three steps:
///
/// 1. The ball that touches the surface at a vertex p, with the normal n outwards, and lies inside of it, has
///    the radius R = min |p − q|² / (2 (p − q)·n) over the other vertices q [Ma, Bae, Choi 2012]. Only q
///    within `cone` of −n are looked at: what lies beside p, a navel or a fold, does not count.
/// 2. p moves to p − part R n; where nothing lies opposite, as on a sheet, it stays.
/// 3. Vertices go to the middle of their neighbours, so often that it evens out what step 2 left rough.
///
/// Triangles may be oriented either way, but all alike. The same on any number of ranks. Collective.
std::vector<Vec3> ways_to_slim(MPI_Comm comm, std::span<const Vec3> positions,
                               std::span<const std::array<Local, 3>> triangles);

} // namespace taut
