#pragma once
#include "partition/mesh_slab.hpp"
#include "partition/topology.hpp"

namespace taut {

/// Entities in transit, by original vertex numbers.
struct SentVertex {
  Global original;
  Vec3 rest_position;
  Global joint; ///< as in MeshSlab; itself without
};
struct SentCell {
  Cell cell;
  Global original;
  Corners2 texture, rest_shape;
};
struct SentEdge {
  Global original, low, high;
  double rest_length; ///< m; 0: by the positions
};
/// A vertex, and that which it is to be sewn or tied to.
using VertexPair = std::array<Global, 2>;

/// The entities this rank stores, still by original numbers.
struct MeshParts {
  std::vector<SentVertex> vertices;
  std::vector<SentCell> cells;
  std::vector<SentEdge> edges;
  std::vector<YarnTriple> triples;
  std::vector<EdgeFaces> hinges;
  std::vector<VertexPair> seams, ties;
};

/// Sends every entity to each rank that owns one of its vertices; `owners` are those of the slab's vertices.
/// Collective.
MeshParts send_parts(MPI_Comm comm, const MeshSlab& mesh, const Topology& topology,
                     const std::vector<int>& owners);

} // namespace taut
