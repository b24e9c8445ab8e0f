#pragma once
#include "src/output/frame_sink.hpp"

namespace taut {

/// What ParaView shows: `frames/frame_NNNNNN.h5`, `frames.xdmf` (cells), `edges.xdmf` (constrained edges),
/// and `obstacles.xdmf` if there are obstacles. Each file appears whole. The XDMF files, in which all frames
/// stand, are rewritten once a second at most: there can be thousands of them. Frames outlive the program,
/// not the machine: waiting for the disk takes longer than writing.
class XdmfSink : public FrameSink {
public:
  explicit XdmfSink(const FrameSource& source);

  static constexpr const char* file = "frames.xdmf";
  static Global count_frames(const std::filesystem::path& folder);
  static void drop_frames(const std::filesystem::path& folder, Global first);

  void begin(Global next) override;
  std::filesystem::path write(const State& state, Global frame) override;
  void flush() override;
  Global frames() const override { return Global(frames_.size()); }

private:
  bool is_list_due() const;

  FrameSource source_;
  std::vector<std::pair<const char*, XdmfText>> lists_; ///< files and their texts
  std::vector<XdmfFrame> frames_;
  std::size_t listed_ = 0; ///< of `frames_`, in the files
  double list_clock_ = 0;  ///< MPI_Wtime() when they were written
};

} // namespace taut
