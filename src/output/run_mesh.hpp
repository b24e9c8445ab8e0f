#pragma once
#include "src/output/frame_fields.hpp"
#include "src/output/obstacle_frames.hpp"

#include <filesystem>

namespace taut {

/// Writes the mesh of a run with those of `fields` that all frames share, in input order, and the faces of
/// obstacles: what formats of frames refer to, and by which a resumed run knows its mesh. The file appears
/// whole. Collective. Throws InputError if it cannot be written.
void write_run_mesh(const std::filesystem::path& file, const Cloth& cloth, std::span<const FrameField> fields,
                    const ObstacleFrames& obstacles, const State& state);

} // namespace taut
