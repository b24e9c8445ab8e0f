#pragma once
#include "partition/mesh_slab.hpp"

namespace taut {

/// What the rectangles of a grid are: quads; two triangles each, all cut along the same diagonal; or two
/// triangles each, cut along one and the other diagonal in turn, like a chess board.
enum class GridCells { quads, triangles, alternating_triangles };

/// A rectangle in the plane z = 0: row i, column j is vertex i*nx + j, at (j Lx/(nx-1), i Ly/(ny-1), 0). Each
/// rank makes its own slab. `vertices` = {nx, ny}, both at least 2; `size` = {Lx, Ly} in metres. Collective.
MeshSlab make_grid(MPI_Comm comm, Vec2 size, std::array<int, 2> vertices, GridCells cells = GridCells::quads);

/// A chain of `vertices` - 1 line elements along x, from the origin; `length` in metres. Collective.
MeshSlab make_line(MPI_Comm comm, double length, Global vertices);

} // namespace taut
