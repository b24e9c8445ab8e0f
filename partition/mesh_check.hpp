#pragma once
#include "partition/mesh_slab.hpp"

namespace taut {

/// "file:line" of something that came from line `line` of the mesh's file, or the mesh's name where there is
/// no line.
std::string place(const MeshSlab& mesh, Global line);

/// Throws InputError, naming the file, the line, and vertices as a case counts them, from 0, for a cell with
/// an edge of zero length, or a face without area: corners on one line, or a quad whose sides cross.
/// Collective.
void check_cells(MPI_Comm comm, const MeshSlab& mesh);

} // namespace taut
