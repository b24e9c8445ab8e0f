#pragma once
#include "src/output/frame_fields.hpp"
#include "src/output/obstacle_frames.hpp"
#include "src/time/step_size.hpp"

#include <filesystem>

namespace taut {

/// What frames are made from. All that is referred to must outlive the sinks that were given it.
struct FrameSource {
  const Cloth& cloth;
  const ObstacleFrames& obstacles;
  const std::vector<FrameField>& fields;
  const StepSize& steps;
  std::filesystem::path folder; ///< of the run
};

/// A format that frames are written in: begun once, then frame by frame. In all of them vertices stand in
/// input order, and a run that is killed leaves whole frames. All collective; what cannot be written is an
/// InputError.
///
/// A class that implements it also has
///   explicit Sink(const FrameSource&);
///   static constexpr const char* file;
///   static Global count_frames(const std::filesystem::path& folder);
///   static void drop_frames(const std::filesystem::path& folder, Global first);
/// the file to open in the folder of a run, and as in frame_formats.hpp.
class FrameSink {
public:
  virtual ~FrameSink() = default;

  /// Gets ready for frame `next`. If it is not 0, the run had those before and goes on.
  virtual void begin(Global next) = 0;

  /// Returns the file that the frame is in.
  virtual std::filesystem::path write(const State& state, Global frame) = 0;

  /// Makes what is written so far complete, where that may wait: at the start and at the end of a run.
  virtual void flush() {}

  /// Frames that are there, those of the run before it was resumed included. Not collective.
  virtual Global frames() const = 0;
};

} // namespace taut
