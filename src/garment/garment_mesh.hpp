#pragma once
#include "partition/mesh_slab.hpp"
#include "src/garment/named_parts.hpp"
#include "src/garment/sample_outlines.hpp"
#include "src/garment/sharpness.hpp"

#include <string>
#include <vector>

namespace taut::garment {

/// What one panel holds of the mesh.
struct MeshedPanel {
  std::string name;
  double edge_length = 0; ///< m, asked for
  double area = 0;        ///< m^2, inside the outline
  Global first_vertex = 0, vertices = 0, first_cell = 0, cells = 0, triangles = 0;
  Outline outline{};     ///< its points are the first vertices of the panel
  SharpPlace sharpest{}; ///< in the plane of the panel
};

/// What one seam joins.
struct MeshedSeam {
  std::string name;
  std::array<double, 2> lengths{};          ///< m, of its edges
  std::vector<std::array<Global, 2>> pairs; ///< vertices that come together, from one end to the other
};

/// The panels of a garment, meshed and placed, not yet sewn. Vertices and cells are numbered panel by panel.
/// A function of pattern and edge lengths alone.
struct GarmentMesh {
  std::vector<Vec3> positions; ///< m
  /// m: along weft and warp, seen from the right side, from the first vertex of the panel on.
  std::vector<Vec2> material;
  std::vector<Cell> cells; ///< counter-clockwise, seen from the right side
  std::vector<MeshedPanel> panels;
  std::vector<MeshedSeam> seams;
  Labels labels;                     ///< of edges and panels: their vertices
  std::vector<std::string> warnings; ///< of what may not be meant, one line each
};

/// Meshes a checked pattern (check_panels). No triangle has an angle below 15 degrees, except in corners of
/// the pattern that are so sharp. Throws `InputError` for a panel that is too thin for that anywhere, or
/// thinner than an edge, and where the mesh would be too large for one rank. Not collective.
GarmentMesh mesh_garment(const SewingPattern& pattern, const EdgeLengths& lengths);

/// The texture of the corners of a cell: u along warp, v along weft (mesh_slab.hpp), counter-clockwise seen
/// from the right side.
Corners2 texture_of(const GarmentMesh& mesh, const Cell& cell);

/// What its parts are called.
NamedParts parts_of(const GarmentMesh& mesh);

/// The mesh that rank 0 holds, in slabs; what the others pass is not used. Collective.
MeshSlab share_out(MPI_Comm comm, const GarmentMesh& mesh, const std::string& name);

} // namespace taut::garment
