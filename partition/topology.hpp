#pragma once
#include "partition/mesh_slab.hpp"

namespace taut {

/// An edge seen from one of its ends.
struct Spoke {
  Global centre;    ///< original number of the vertex whose star this is
  Global neighbour; ///< original number of the other end
  Global edge;      ///< original number of the constrained edge, or -1 for an edge that is not constrained
  std::array<Global, 2> cells; ///< the cells that have the edge, -1 for none
  double rest_length;          ///< m, where the cells have a rest shape of their own, else 0
  Global is_thread;            ///< 1 of a side of a quad and of a line, 0 of a side of triangles alone
};

/// Two edges that go straight through a vertex: consecutive vertices of one yarn.
struct YarnTriple {
  Global before, centre, after; ///< original vertex numbers
  bool operator==(const YarnTriple&) const = default;
};

/// The two faces of an edge laid flat, m: how long the edge is, and of the middle of the other vertices of
/// the face to its left and of that to its right, how far along the edge it is from the lower vertex, and how
/// far beside it.
struct UnfoldedFaces {
  double length = 0;
  Vec2 left = Vec2::Zero(), right = Vec2::Zero();
};

/// An edge between two faces, over which cloth folds: the edge from its lower to its higher vertex, and the
/// other vertices of the face to the left of it and of that to the right: two of a quad, one of a triangle
/// (the second is then -1).
struct EdgeFaces {
  Global low, high; ///< original vertex numbers
  std::array<Global, 2> left, right;
  std::array<Global, 2> cells; ///< the face to the left, that to the right
  Vec2 run;                    ///< of the texture from the lower to the higher vertex; zero in a mesh without
  UnfoldedFaces at_rest;       ///< zero where the rest shape is that of the positions
};

/// The vertices of a hinge; unused places repeat the one before.
inline std::array<Global, 6> vertices_of(const EdgeFaces& h) {
  const auto or_first = [](Global second, Global first) { return second >= 0 ? second : first; };
  return {
      h.low, h.high, h.left[0], or_first(h.left[1], h.left[0]), h.right[0], or_first(h.right[1], h.right[0])};
}

/// Which edges count as constrained in a mesh of triangles and other cells.
enum class ConstrainedEdges {
  threads, ///< the sides of quads and the lines
  all      ///< those of triangles too, as what is averaged over triangles needs
};

/// What follows from the cells of a mesh alone, shared out by the vertex slabs, so that it does not depend on
/// the partition. Constrained edges are the edges of quads and the line elements, and all edges of a mesh of
/// triangles alone, or of any if that is asked for; they are numbered by (lower vertex, higher vertex),
/// lexicographically.
struct Topology {
  bool triangles_only = false;     ///< no quad and no line in the whole mesh
  bool has_triangles = false;      ///< any
  Global constrained_edges = 0;    ///< over all ranks
  std::vector<Spoke> spokes;       ///< stars of this slab's vertices, sorted by (centre, neighbour)
  std::vector<std::size_t> star;   ///< the star of slab vertex i is spokes[star[i] .. star[i + 1])
  std::vector<YarnTriple> triples; ///< centred at this slab's vertices, by centre
  std::vector<EdgeFaces> hinges;   ///< whose lower vertex is in this slab, by (low, high)
};

/// Finds edges, stars and yarn triples, and checks the mesh on the way. Two threads continue one
/// another through a vertex if they share no cell there and neither has another such partner: opposite edges
/// of a regular vertex, the two boundary edges of a border vertex, the two lines of a chain. In a mesh of
/// triangles alone there are no yarns; there edges are chained by their coupling in the projection matrix: of
/// the edges around a vertex, those that go on most nearly straight are paired first. Throws
/// InputError (naming the file and the line) for a mesh with isolated vertices, edges of zero length, doubled
/// edges, more than two faces on an edge, or neighbouring faces of opposite orientation. Collective.
Topology find_topology(MPI_Comm comm, const MeshSlab& mesh,
                       ConstrainedEdges constrained = ConstrainedEdges::threads);

} // namespace taut
