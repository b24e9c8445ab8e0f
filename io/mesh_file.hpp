#pragma once
#include "io/obj_parser.hpp"
#include "partition/mesh_slab.hpp"

#include <mpi.h>

#include <filesystem>

/// Meshes from files. All collective; errors are `InputError`, the same on all ranks.
namespace taut {

/// The mesh in `path`, read by what its extension says (.obj, .ply, .stl, .h5); coordinates are multiplied by
/// `scale` (m per unit of the file). `polygons` are faces with more than 4 corners, which OBJ may have.
MeshSlab read_mesh(MPI_Comm comm, const std::filesystem::path& path, double scale,
                   Polygons polygons = Polygons::refuse);

/// The mesh in an HDF5 file: `/rest_positions` (n, 3) numbers; `/faces` (k) integers, the vertices of one
/// cell after the other, counted from 0; `/face_offsets` (f + 1) integers: cell c has the vertices at
/// [offsets[c], offsets[c + 1]) of `/faces`, 2 to 4 of them; if it is there, `/texture` (k, 2) numbers, u and
/// v of each corner in `/faces` (MeshSlab::texture), and likewise `/rest_shape` (MeshSlab::rest_shape). No
/// rank holds more than its slab.
MeshSlab read_mesh_h5(MPI_Comm comm, const std::filesystem::path& path, double scale);

/// Only places, for a start shape: as `read_obj_positions` (obj.hpp), or of a file .h5, as frames of runs
/// are,
/// `/positions` (n, 3) numbers.
std::vector<Vec3> read_positions(MPI_Comm comm, const std::filesystem::path& path, double scale,
                                 Slab expected);

} // namespace taut
