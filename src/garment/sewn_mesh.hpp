#pragma once
#include "src/garment/garment_mesh.hpp"

namespace taut::garment {

/// For each vertex of a garment the first of those that come to one place when all seams are closed, or
/// itself. Vertices of several seams are one.
std::vector<Global> joints_of(const GarmentMesh& mesh);

/// A garment as one mesh. Panels, seams and labels as names with what they consist of.
struct SewnMesh {
  std::vector<Vec3> positions;           ///< m
  std::vector<Cell> cells;               ///< as those of the panels
  std::vector<Corners2> texture;         ///< of the corners of each cell, m: u along warp, v along weft
  std::vector<Corners2> rest_shape;      ///< m, see MeshSlab
  std::vector<Global> number;            ///< of each vertex of the panels, here
  std::vector<std::vector<Global>> seam; ///< the vertices of each seam of the panels
  std::map<std::string, std::vector<Global>> labels;
};

/// What `mesh` becomes when its vertices are at `positions` and those that belong together are made one, in
/// the middle. A side that two panels share is as long as the shorter of its two: the other is gathered to
/// it. Throws `InputError` if a cell would lose a side. Not collective.
SewnMesh sew(const GarmentMesh& mesh, std::span<const Vec3> positions, const std::string& name);

} // namespace taut::garment
