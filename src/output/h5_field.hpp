#pragma once
#include "io/hdf5.hpp"
#include "io/xdmf.hpp"
#include "src/output/frame_fields.hpp"

namespace taut {

/// Writes what `field` is in `state`, in input order. Collective.
void write_field(H5Writer& file, const DistributedMesh& mesh, const FrameField& field, const State& state);

/// What XDMF has to know of the field where edges or cells are its cells.
XdmfField describe(const FrameField& field);

} // namespace taut
