#pragma once
#include "src/output/frame_sink.hpp"

namespace taut {

/// Positions alone, as `frames.pc2` (io/pc2.hpp). Its first frame is that of the start, or the one after
/// which the format was first asked for, as the header says.
class Pc2Sink : public FrameSink {
public:
  /// Throws InputError for more vertices than the format can count.
  explicit Pc2Sink(const FrameSource& source);

  static constexpr const char* file = "frames.pc2";
  static Global count_frames(const std::filesystem::path& folder);
  static void drop_frames(const std::filesystem::path& folder, Global first);

  void begin(Global next) override;
  std::filesystem::path write(const State& state, Global frame) override;
  Global frames() const override { return frames_; }

private:
  const DistributedMesh& mesh_;
  std::filesystem::path path_;
  Global first_ = 0;  ///< frame of the run that is the first of the file
  Global frames_ = 0; ///< in the file
};

} // namespace taut
