#pragma once
#include "partition/distributed_mesh.hpp"
#include "src/config/case.hpp"
#include "src/garment/named_parts.hpp"

namespace taut {

/// A panel that is of another material than its piece.
struct PanelMaterial {
  Global first_cell = 0, cells = 0; ///< within the piece
  config::Material material;
};

/// One of the cloths of a case. No cell has vertices of two of them.
struct Piece {
  config::Material material;
  Global first_vertex = 0; ///< its vertices and cells follow those of the piece before
  Global first_cell = 0;
  Global vertices = 0, cells = 0;      ///< how many, over all ranks
  bool triangles_only = false;         ///< no quad and no line in it
  garment::NamedParts parts{};         ///< names, of what is numbered within the piece
  std::vector<std::string> warnings{}; ///< of its pattern, on rank 0
  std::vector<PanelMaterial> own{};    ///< of panels, in the order of their cells
};

/// Cells in a row that are of one material.
struct Section {
  Global first_cell = 0; ///< up to that of the next section
  std::size_t piece = 0;
  std::optional<std::size_t> own{}; ///< which of the piece's panels it is, if of another material
};

/// Two vertices, by original numbers, that an attachment of the case draws together.
struct Tie {
  std::array<Global, 2> vertices;
  std::size_t attachment;
};

/// What does not change during a run: the mesh and what the rest shape and the material make of it.
struct Cloth {
  DistributedMesh mesh;
  std::vector<Piece> pieces;       ///< at least one
  std::vector<Section> sections;   ///< all cells, in order
  std::vector<Tie> ties;           ///< all, on every rank
  std::vector<double> measure;     ///< of local vertices: m^2 of cloth (m of line) that belong to each
  std::vector<double> mass;        ///< kg, of local vertices, lumped
  std::vector<double> rest_length; ///< m, of local edges

  /// The number of the piece that a vertex, by its original number, belongs to.
  std::size_t piece_of_original(Global vertex) const;
  std::size_t piece_of(Local vertex) const {
    return pieces.size() == 1 ? 0 : piece_of_original(mesh.vertices.original[vertex]);
  }

  /// The number of the section that a cell, by its original number, belongs to.
  std::size_t section_of(Global cell) const;
  const config::Material& material_of(const Section& section) const {
    const Piece& piece = pieces[section.piece];
    return section.own ? piece.own[*section.own].material : piece.material;
  }
};

/// Derives masses and lengths; `pieces` in order. Collective.
Cloth make_cloth(DistributedMesh distributed, std::vector<Piece> pieces);

/// Of one piece. Collective.
Cloth make_cloth(DistributedMesh distributed, const config::Material& material);

/// What the parts of all cloths are called, in the numbers of all. Of several cloths the panels are named
/// with the number of theirs, "1.front"; where any has panels, a cloth without is one, "2". Labels of one
/// name are one.
garment::NamedParts parts_of(const Cloth& cloth);

/// |d| / l - 1 of an edge.
inline double strain_of(const Cloth& cloth, std::span<const Vec3> positions, Local edge) {
  const auto& [a, b] = cloth.mesh.edge_vertices[edge];
  return (positions[b] - positions[a]).norm() / cloth.rest_length[edge] - 1.0;
}

struct Strain {
  double max = 0; ///< largest |strain| of all that the limit holds for, see StrainGauge
  double rms = 0;
  double of_edges = 0, of_averages = 0; ///< largest of each kind; 0 where there is none
};

/// How far the lowest vertex, in the direction `down`, is below the origin, in m. Collective.
double lowest(const Cloth& cloth, std::span<const Vec3> positions, const Vec3& down);

} // namespace taut
