#pragma once
#include "src/garment/garment_mesh.hpp"
#include "src/garment/sewn_mesh.hpp"

#include <filesystem>

/// Meshes of garments as files that taut reads (io/mesh_file.hpp). All collective; the mesh that rank 0 holds
/// is written. Throw `InputError` if the file cannot be written.
namespace taut::garment {

/// Wavefront OBJ: positions, `vt` with u along warp and v along weft, in m, a group for each panel.
void write_obj(MPI_Comm comm, const GarmentMesh& mesh, const std::filesystem::path& path);

/// HDF5: `/rest_positions` (n, 3) m, `/faces`, `/face_offsets`, `/texture` (corners, 2) m, and `/cells/panel`
/// (cells), `/seams/pairs` (p, 2) vertices with `/seams/offsets`, `/labels/vertices` with `/labels/offsets`;
/// attributes `panels`, `seams` and `labels` hold the names, as lists in JSON.
void write_h5(MPI_Comm comm, const GarmentMesh& mesh, const std::filesystem::path& path);

/// The same of a garment that is sewn: also `/rest_shape` (corners, 2) m, see MeshSlab; `/seams/vertices`
/// with
/// `/seams/offsets`. `mesh` is that of the panels.
void write_h5(MPI_Comm comm, const GarmentMesh& mesh, const SewnMesh& sewn,
              const std::filesystem::path& path);

} // namespace taut::garment
