#pragma once
#include "src/config/case.hpp"
#include "src/garment/garment_mesh.hpp"

namespace taut::garment {

/// For each vertex of a garment the first of those that come to one place when all seams are closed, or
/// itself. Vertices of several seams are one.
std::vector<Global> joints_of(const GarmentMesh& mesh);

/// A garment as one mesh. Panels, seams and labels as names with what they consist of.
struct SewnMesh {
  std::vector<Vec3> positions;           ///< m
  std::vector<Cell> cells;               ///< as those of the panels, oriented alike (turn_panels.hpp)
  std::vector<Corners2> texture;         ///< of the corners of each cell, m: u along warp, v along weft
  std::vector<Corners2> rest_shape;      ///< m, see MeshSlab
  std::vector<Global> number;            ///< of each vertex of the panels, here
  std::vector<std::vector<Global>> seam; ///< the vertices of each seam of the panels
  Labels labels;
};

/// Sides between vertices of a set are shorter at rest.
struct ShorterSides {
  std::string label;
  std::vector<Global> vertices; ///< of the panels, ascending
  double part = 1;              ///< of the length as cut
};

/// What is elastic in cloth k of a case. Throws `InputError`, naming the key, for a label that the mesh does
/// not have.
std::vector<ShorterSides> shorter_sides(const GarmentMesh& mesh, const Case& input, std::size_t k);

/// What `mesh` becomes when its vertices are at `positions` and those that belong together are made one, in
/// the middle. A side that two panels share is as long as the shorter of its two: the other is gathered to
/// it; so is all to what is `shorter`. Throws `InputError` if a cell would lose a side, for a quad of which
/// some sides are shorter, and for panels that cannot be oriented alike. Not collective.
SewnMesh sew(const GarmentMesh& mesh, std::span<const Vec3> positions, const std::string& name,
             std::span<const ShorterSides> shorter = {});

/// What the parts of a sewn garment are called; `mesh` is that of its panels.
NamedParts parts_of(const GarmentMesh& mesh, const SewnMesh& sewn);

} // namespace taut::garment
