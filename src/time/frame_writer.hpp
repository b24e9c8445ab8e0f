#pragma once
#include "src/forces/stretch.hpp"
#include "src/time/contact_frames.hpp"
#include "src/time/observer.hpp"
#include "src/time/obstacle_frames.hpp"

#include <filesystem>

namespace taut {

/// Writes what ParaView shows: `mesh.h5`, `frames/frame_NNNNNN.h5`, `frames.xdmf` (cells) and `edges.xdmf`
/// (constrained edges), everything in input order, and `obstacles.xdmf` if there are obstacles. Each file
/// appears whole. The XDMF files, in which all frames stand, are rewritten once a second at most: there can
/// be thousands of them. Frames outlive the program, not the machine: waiting for the disk takes longer than
/// writing.
class FrameWriter : public Observer {
public:
  /// `cloth` and `obstacles` must outlive the writer; `folder` exists. `earlier` are the frames a resumed run
  /// has in it already, from the start on; none: the start is written too. Collective.
  FrameWriter(const Cloth& cloth, const Obstacles& obstacles, const Case& input, std::filesystem::path folder,
              std::vector<XdmfFrame> earlier = {});

  /// Relative to the folder.
  static std::string file_of(Global frame);

  void at_start(const State& state) override;
  void after_frame(const State& state, Global frame) override;

  Global frames() const { return Global(frames_.size()); }
  double seconds() const { return seconds_; }

  /// Brings the XDMF files up to date. Collective.
  void list_frames();

  /// The files of the frames since the last call.
  std::vector<std::filesystem::path> take_written();

private:
  void write_mesh();
  void write_yarns(H5Writer& file) const;
  void write_cloth_numbers(H5Writer& file) const;
  void write_frame(const State& state, Global frame);
  bool is_list_due() const;
  void describe(Global cells_length);
  XdmfDescription describe_cells(Global cells_length) const;
  XdmfDescription describe_edges() const;
  bool wants(config::Field field) const;

  const Cloth& cloth_;
  std::vector<config::Field> fields_;
  std::filesystem::path folder_;
  ObstacleFrames obstacles_;
  std::optional<ContactFrames> contact_; ///< if there is contact, and its fields are wanted
  std::vector<XdmfFrame> frames_;
  std::size_t listed_ = 0;                             ///< of `frames_`, in the XDMF files
  double list_clock_ = 0;                              ///< MPI_Wtime() when they were written
  std::size_t taken_;                                  ///< of `frames_`, by `take_written`
  std::vector<std::pair<const char*, XdmfText>> xdmf_; ///< files and their texts
  double seconds_ = 0;
};

} // namespace taut
