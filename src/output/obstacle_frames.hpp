#pragma once
#include "io/xdmf.hpp"
#include "src/contact/obstacle_surface.hpp"
#include "src/state/cloth.hpp"

namespace taut {

class H5Writer;

/// The obstacles in the files of a run: `/obstacles/...` in mesh.h5 and in every frame, and what
/// `obstacles.xdmf` says of them.
class ObstacleFrames {
public:
  /// `cloth` is as large as planes are shown, `obstacles` must outlive it. Collective.
  ObstacleFrames(const Cloth& cloth, const Obstacles& obstacles);

  bool empty() const { return surface_.empty(); }
  void write_faces(H5Writer& file) const;                  ///< once. Collective.
  void write_positions(H5Writer& file, double time) const; ///< into a frame. Collective.

  XdmfText xdmf() const; ///< of `obstacles.xdmf`, without frames yet

private:
  MPI_Comm comm_;
  ObstacleSurface surface_;
};

} // namespace taut
