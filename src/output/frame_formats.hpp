#pragma once
#include "src/output/frame_sink.hpp"

#include <memory>

/// All formats of frames. A new one is a FrameSink, a word in config::FrameFormat, and a line in
/// frame_formats.cpp.
namespace taut {

/// Each format once. Collective.
std::vector<std::unique_ptr<FrameSink>> make_sinks(const FrameSource& source,
                                                   std::span<const config::FrameFormat> wanted);

/// In the folder of a run, what to open to look at the frames. Not collective.
std::vector<const char*> files_of(std::span<const config::FrameFormat> wanted);

/// Whether the folder of a run holds frames of any format. Not collective.
bool holds_frames(const std::filesystem::path& folder);

/// How many, in the format with most. Not collective.
Global count_frames(const std::filesystem::path& folder);

/// Removes the frames from `first` on, of every format; with 0 all that was written for them. Not collective.
/// Throws filesystem_error or InputError if the system refuses.
void drop_frames(const std::filesystem::path& folder, Global first);

} // namespace taut
