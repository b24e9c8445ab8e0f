#pragma once
#include "partition/distributed_mesh.hpp"

namespace taut {

/// The hinges over the sides of one triangle: one to three.
struct HingesOfTriangle {
  std::array<Global, 3> corners; ///< ascending
  std::vector<EdgeFaces> hinges; ///< by (low, high)

  std::vector<Global> vertices() const; ///< of all its hinges; some more than once
};

/// Of all triangles that have a neighbour, those whose lowest corner is in this rank's slab of the vertices.
/// `hinges` as in Topology. Collective.
std::vector<HingesOfTriangle> hinges_of_triangles(MPI_Comm comm, const Slab& vertices,
                                                  std::span<const EdgeFaces> hinges);

/// A triangle and those around it, all of which are triangles.
struct TrianglePatch {
  std::array<Local, 3> hinges;   ///< of the mesh, over its sides, in their order; then -1
  std::array<Local, 6> vertices; ///< edge of the first hinge, third corner, vertices across the hinges
};

/// The patches that touch an owned vertex; where there is no hinge the last vertex is repeated. In an order
/// that does not depend on the partition.
std::vector<TrianglePatch> triangle_patches(const DistributedMesh& mesh);

} // namespace taut
