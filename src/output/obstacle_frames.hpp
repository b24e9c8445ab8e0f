#pragma once
#include "io/xdmf.hpp"
#include "src/contact/obstacle_surface.hpp"
#include "src/state/cloth.hpp"

namespace taut {

class H5Writer;

/// The obstacles in the files of a run: `/obstacles/...` in mesh.h5 and, if any of them moves, in every
/// frame, and what `obstacles.xdmf` says of them.
class ObstacleFrames {
public:
  /// `cloth` is as large as planes are shown, `obstacles` must outlive it. Collective.
  ObstacleFrames(const Cloth& cloth, const Obstacles& obstacles);

  bool empty() const { return surface_.empty(); }
  void write_once(H5Writer& file) const;               ///< faces, and places if all rest. Collective.
  void write_frame(H5Writer& file, double time) const; ///< places, unless all rest. Collective.

  XdmfText xdmf() const; ///< of `obstacles.xdmf`, without frames yet

private:
  void write_positions(H5Writer& file, double time) const;

  MPI_Comm comm_;
  bool all_rest_;
  ObstacleSurface surface_;
};

} // namespace taut
