#pragma once
#include "io/obj_parser.hpp"
#include "partition/mesh_slab.hpp"

#include <mpi.h>

#include <filesystem>
#include <vector>

/// Wavefront OBJ files, and surfaces of other formats that are read alike. Rank 0 reads and parses the file
/// and sends every rank its slab, so the file must fit into the memory of one rank; larger meshes come as
/// HDF5 (mesh_file.hpp). Which elements are understood: obj_parser.hpp. All collective; errors are
/// `InputError`, the same on all ranks, "file.obj:17: what is wrong; cure".
namespace taut {

/// The mesh in the file `path`, its coordinates multiplied by `scale` (m per unit of the file): OBJ, or by
/// the extension .ply (ply.hpp) or .stl (stl.hpp). Rank 0 warns on stderr of lines that are not known, and of
/// vertices of no face and no line; both are left out, and vertices are numbered without them.
MeshSlab read_obj(MPI_Comm comm, const std::filesystem::path& path, double scale,
                  Polygons polygons = Polygons::refuse);

/// Only the places of the vertices, for a start shape: rank's slab `expected` of as many vertices as
/// `expected.total`, m. Throws also if the file holds another number of vertices. Elements are parsed, then
/// ignored.
std::vector<Vec3> read_obj_positions(MPI_Comm comm, const std::filesystem::path& path, double scale,
                                     Slab expected);

} // namespace taut
