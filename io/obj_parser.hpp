#pragma once
#include "partition/mesh_slab.hpp"
#include "partition/types.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace taut {

/// What becomes of faces with more than 4 corners: an error, or triangles around the first corner.
enum class Polygons { refuse, triangulate };

/// A whole Wavefront OBJ file in the memory of one rank.
struct ObjFile {
  std::vector<Vec3> positions;      ///< as in the file, without scale
  std::vector<Cell> cells;          ///< faces and segments of polylines, in the order of the file
  std::vector<Corners2> texture;    ///< of the corners of each cell, zero without; empty if no face has it
  std::vector<Global> vertex_lines; ///< 1-based line of each vertex
  std::vector<Global> cell_lines;   ///< 1-based line of each cell

  /// Lines that begin with a word that is not known here.
  struct Unknown {
    Global lines = 0, first_line = 0;
    std::string first_word;
  } unknown;
};

/// Understands `v`, `vt`, `f` with 3 or 4 vertices, or more as `polygons` says (a, a/b, a//c, a/b/c, relative
/// numbers) and `l`; leaves out `vn g o s usemtl mtllib`, and counts lines that begin with other words. Not
/// collective. Throws `InputError` "`name`:line: what is wrong; cure".
ObjFile parse_obj(std::string_view text, const std::string& name, Polygons polygons = Polygons::refuse);

/// Takes out vertices that no cell has; cells then name the others by their new numbers. Files without cells
/// keep all. How many there were, and the line of the first.
struct Unused {
  Global vertices = 0, first_line = 0;
};
Unused drop_unused(ObjFile& file);

} // namespace taut
