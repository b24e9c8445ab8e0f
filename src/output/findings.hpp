#pragma once
#include "src/contact/intersections.hpp"

#include <string>

namespace taut {

/// Intersections as a VTK PolyData file of points for ParaView: the places, the vertices in play (original
/// numbers, those of obstacles after them) and the obstacle, -1 for the cloth. Of each rank the first
/// thousands, so that rank 0 can hold them all. The text is that of rank 0. Collective.
std::string findings_as_vtp(MPI_Comm comm, std::span<const Intersection> found);

} // namespace taut
