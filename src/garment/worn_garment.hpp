#pragma once
#include "src/garment/garment_mesh.hpp"

#include <filesystem>

namespace taut::garment {

/// A garment as a run left it: where each place of its pattern is in space. From there another mesh of the
/// same pattern, finer or coarser, takes its start. On rank 0; empty on the others.
class WornGarment {
public:
  /// Reads the mesh of a run (`/faces`, `/texture`, `/cells/panel` and the names of panels) and a frame.
  /// Collective; throws `InputError`.
  WornGarment(MPI_Comm comm, const std::filesystem::path& mesh, const std::filesystem::path& frame);

  /// Where the vertices of `mesh` are on it, m: linear within its triangles, a quad being the two that
  /// contact takes it for, so that nothing intersects on the finer mesh that does not on this one; beyond an
  /// outline, of which a coarse mesh cuts off curves, as the nearest triangle goes on. A panel is found by
  /// the name `prefix` + its own. Throws `InputError` for a panel that the run does not have, or has of
  /// another shape, and for a seam that is open there. Not collective.
  std::vector<Vec3> carry(const GarmentMesh& mesh, const std::string& prefix) const;

private:
  struct Triangle {
    std::array<Vec2, 3> texture; ///< m, as texture_of
    std::array<Vec3, 3> places;  ///< m
  };
  struct WornPanel {
    std::string name;
    std::vector<Triangle> triangles;
  };
  class Grid;
  const WornPanel& panel(const std::string& name) const;
  void check_seams(const GarmentMesh& mesh, std::span<const Vec3> places) const;

  std::string name_; ///< how messages call it: the file of the mesh
  std::vector<WornPanel> panels_;
  double longest_side_ = 0; ///< m, of its triangles
};

} // namespace taut::garment
