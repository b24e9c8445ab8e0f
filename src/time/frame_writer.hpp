#pragma once
#include "src/forces/stretch.hpp"
#include "src/time/contact_frames.hpp"
#include "src/time/observer.hpp"
#include "src/time/obstacle_frames.hpp"

#include <filesystem>

namespace taut {

/// Writes what ParaView shows: `mesh.h5`, `frames/frame_NNNNNN.h5`, `frames.xdmf` (cells) and `edges.xdmf`
/// (constrained edges), everything in input order, and `obstacles.xdmf` if there are obstacles. Each file
/// appears whole; the XDMF files are rewritten after every frame.
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

  Global frames() const { return Global(cells_.frames.size()); }
  double seconds() const { return seconds_; }

private:
  void write_mesh();
  void write_yarns(H5Writer& file) const;
  void write_cloth_numbers(H5Writer& file) const;
  void write_frame(const State& state, Global frame);
  void write_xdmf() const;
  void describe(bool has_mixed_cells);
  bool wants(config::Field field) const;

  const Cloth& cloth_;
  std::vector<config::Field> fields_;
  std::filesystem::path folder_;
  ObstacleFrames obstacles_;
  std::optional<ContactFrames> contact_; ///< if there is contact, and its fields are wanted
  XdmfDescription cells_, edges_;
  double seconds_ = 0;
};

} // namespace taut
