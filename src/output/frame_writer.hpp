#pragma once
#include "src/output/frame_formats.hpp"
#include "src/output/written.hpp"
#include "src/time/observer.hpp"

namespace taut {

/// Writes the frames of a run in all formats that the case asks for, and its mesh, to which they refer.
class FrameWriter : public Observer {
public:
  /// `steps` are those of the run; `folder` exists; what is written is added to `written`. All references but
  /// `input` must outlive the writer. Collective.
  FrameWriter(const Cloth& cloth, const Obstacles& obstacles, const StepSize& steps, const Case& input,
              const std::filesystem::path& folder, Written& written);

  /// The state of a run that has made steps already is no frame.
  void at_start(const State& state) override;
  void after_frame(const State& state, Global frame) override;

  /// Completes the files at the end of a run. Collective.
  void flush();

  Global frames() const; ///< that are there, in the format with most

private:
  std::vector<FrameField> fields_;
  ObstacleFrames obstacles_;
  FrameSource source_;
  std::vector<std::unique_ptr<FrameSink>> sinks_;
  Written& written_;
};

} // namespace taut
