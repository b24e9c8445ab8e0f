#pragma once
#include "partition/mesh_slab.hpp"

namespace taut {

/// "file:line" of something that came from line `line` of the mesh's file, or the mesh's name where there is
/// no line.
std::string place(const MeshSlab& mesh, Global line);

/// A vertex or cell as the mesh's file counts them: from 1 in OBJ; from 0 elsewhere, as everywhere in a case.
Global number_in_file(const MeshSlab& mesh, Global index);

/// Throws InputError, naming the file and the line, for a cell with an edge of zero length, or a face without
/// area: corners on one line, or a quad whose sides cross. Collective.
void check_cells(MPI_Comm comm, const MeshSlab& mesh);

} // namespace taut
