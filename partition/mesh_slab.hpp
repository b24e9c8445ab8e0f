#pragma once
#include "partition/comm.hpp"
#include "partition/types.hpp"

#include <array>
#include <string>
#include <vector>

namespace taut {

/// The part [first, first + count) of a list of `total` entities cut into nearly equal, contiguous pieces in
/// original order, one a rank.
struct Slab {
  Global first = 0;
  Global count = 0;
  Global total = 0;

  bool contains(Global i) const { return i >= first && i < first + count; }
};

/// The slab of `rank`: the first (total mod ranks) slabs hold one entity more.
Slab slab_of(Global total, int ranks, int rank);

/// The rank whose slab holds entity `i`.
int slab_rank(Global total, int ranks, Global i);

/// A cell of the mesh: a line element (2 vertices), a triangle (3) or a quad (4), vertices in original
/// numbers, counter-clockwise; unused places hold -1.
struct Cell {
  std::array<Global, 4> vertices{-1, -1, -1, -1};

  int size() const { return vertices[2] < 0 ? 2 : vertices[3] < 0 ? 3 : 4; }
};

/// A point in the plane of the cloth for each corner of a cell; unused places are zero.
using Corners2 = std::array<Vec2, 4>;

/// A mesh as read or made: every rank holds one slab of the vertices and one of the cells. No rank holds
/// more.
struct MeshSlab {
  std::string name = "mesh";        ///< how messages call it: the file, or "grid"
  Slab vertices;                    ///< which vertices `rest_positions` holds
  Slab cells;                       ///< which cells `cell` holds
  std::vector<Vec3> rest_positions; ///< m
  std::vector<Cell> cell;
  std::vector<Corners2>
      texture; ///< material coordinates of the corners of each cell, as in the file: u
               ///< along warp, v along weft; zero for a cell without; empty if no cell has any
  std::vector<Corners2> rest_shape; ///< m: the shape at rest of cells that do not have it by the places of
                                    ///< their vertices, as those of a garment that is sewn; zero for the
                                    ///< others; empty if all are such. Cells agree on the lengths of sides.
  std::vector<Global> joint; ///< of each vertex the first of those it is to be sewn together with, or itself;
                             ///< empty if there is nothing to sew
  std::vector<std::array<Global, 2>> ties; ///< vertices that a force couples beyond cells; all ranks hold all
  std::vector<Global>
      vertex_lines; ///< line of each vertex in the file it came from; empty if it came from none
  std::vector<Global> cell_lines; ///< the same for cells
};

/// The slab of this rank of a mesh that every rank has whole, as small programs do. Not collective.
MeshSlab slab_of_whole(MPI_Comm comm, const std::vector<Vec3>& points, const std::vector<Cell>& cells);

} // namespace taut
