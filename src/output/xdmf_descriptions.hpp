#pragma once
#include "io/xdmf.hpp"
#include "src/output/frame_fields.hpp"

/// What the XDMF files of a run say of its HDF5 files. All collective.
namespace taut {

XdmfCells shape_of(const DistributedMesh& mesh);

/// Of `frames.xdmf`: faces and line elements, with the fields of vertices and cells.
XdmfDescription describe_cells(const DistributedMesh& mesh, std::span<const FrameField> fields);

/// Of `edges.xdmf`: constrained edges with their fields.
XdmfDescription describe_edges(const DistributedMesh& mesh, std::span<const FrameField> fields);

} // namespace taut
