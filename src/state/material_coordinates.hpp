#pragma once
#include "partition/distributed_mesh.hpp"

namespace taut {

/// Where the corners of a face of the mesh lie in the plane of the cloth, in m: u along warp, v along weft,
/// with the shape of the face at rest. A triangle of a mesh with texture coordinates has its warp where u
/// grows and v does not; without them, and where the texture of a triangle has no area, warp runs along x as
/// nearly as the plane of the triangle allows (along y if that is perpendicular to x).
Corners2 material_coordinates(const DistributedMesh& mesh, std::size_t cell);

/// Which sides of a quad are its warp: 0 for the sides 0-1 and 3-2; 1 for the other two, where the texture
/// says that v grows more than u along 0-1 and 3-2.
int warp_side(const DistributedMesh& mesh, std::size_t cell);

/// Warp of a face with this normal in a mesh without texture; of length one.
Vec3 default_warp(const Vec3& normal);

} // namespace taut
