#pragma once
#include "partition/index_map.hpp"
#include "partition/partitioner.hpp"

namespace taut {

/// A cell by local vertex numbers; unused places hold -1.
struct LocalCell {
  std::array<Local, 4> vertices;

  int size() const { return vertices[2] < 0 ? 2 : vertices[3] < 0 ? 3 : 4; }
};

/// An edge between two faces (see EdgeFaces) by local vertex numbers; unused places hold -1.
struct Hinge {
  std::array<Local, 2> edge;
  std::array<Local, 2> left, right;
  std::array<Global, 2> cells; ///< their original numbers; they need not be here
  Vec2 run;
  UnfoldedFaces at_rest;

  /// 4 between triangles, 5 between a triangle and a quad, 6 between quads.
  int size() const { return 4 + (left[1] >= 0) + (right[1] >= 0); }
};

/// The vertices of a hinge: its edge, left, right; unused places repeat the one before.
inline std::array<Local, 6> vertices_of(const Hinge& h) {
  return {h.edge[0],  h.edge[1],
          h.left[0],  h.left[1] < 0 ? h.left[0] : h.left[1],
          h.right[0], h.right[1] < 0 ? h.right[0] : h.right[1]};
}

/// One end of an edge, seen from a vertex.
struct EdgeEnd {
  Local edge;
  Local other; ///< the vertex at the other end
  float sign;  ///< +1 if this vertex is the edge's second, -1 if its first
};

struct PartitionReport {
  Global edge_cut = 0;    ///< constrained edges whose ends have different owners
  double imbalance = 1.0; ///< largest number of owned vertices over the mean
  Global ghosts_max = 0;  ///< ghost vertices of the rank that has most
};

/// One rank's part of the mesh. A rank stores the star (all neighbours and constrained edges) of every vertex
/// that is one of its own or a neighbour of one, and every cell, yarn triple and hinge that touches one of
/// its own vertices; of a triangle all hinges, if one of them does. So it can assemble all rows of what it
/// owns, of vertices and of edges, without communication.
///
/// Within a rank, vertices are numbered along a Morton curve through the rest shape and edges yarn by yarn.
/// Cells, triples and hinges, and the edges around a vertex, stand in an order that does not depend on the
/// partition, so that sums over them are the same to the last bit at any rank count.
struct DistributedMesh {
  MPI_Comm comm = MPI_COMM_NULL;
  IndexMap vertices;
  IndexMap
      edges; ///< constrained edges; an edge belongs to the owner of its lower vertex (in original numbers)
  Halo vertex_halo;
  Halo edge_halo;

  std::vector<Vec3> rest_positions;         ///< m, of local vertices
  bool triangles_only = false;              ///< no quad and no line in the whole mesh
  bool has_triangles = false;               ///< in the whole mesh
  std::vector<LocalCell> cells;             ///< local cells
  std::vector<Global> cell_originals;       ///< their original numbers
  std::vector<Corners2> texture;            ///< of local cells; empty if the mesh has none
  std::vector<Corners2> rest_shape;         ///< the same; see MeshSlab
  std::vector<Local> owned_cells;           ///< those of `cells` this rank owns: each cell has one owner
  std::vector<Global> owned_cell_originals; ///< their original numbers
  Global total_cells = 0;
  std::vector<std::array<Local, 2>> edge_vertices; ///< of local edges, lower original number first
  std::vector<double> rest_lengths;                ///< m, of local edges
  std::vector<std::array<Local, 3>> triples;       ///< before, centre, after
  std::vector<Hinge> hinges;
  std::vector<Global> joint;               ///< of local vertices: original numbers, see MeshSlab
  std::vector<std::array<Local, 2>> seams; ///< a vertex and its joint, if they differ and one is owned
  std::vector<std::array<Local, 2>> ties;  ///< those of MeshSlab of which one end is owned
  std::vector<std::size_t> star;           ///< the edges of local vertex i: ends[star[i] .. star[i + 1])
  std::vector<EdgeEnd> ends;

  OriginalOrder vertex_order, edge_order, cell_order; ///< to files and back
  PartitionReport report;

  std::span<const EdgeEnd> star_of(Local vertex) const {
    return {ends.data() + star[vertex], star[vertex + 1] - star[vertex]};
  }
  bool owns_vertex(Local i) const { return i < vertices.owned; }
  bool owns_edge(Local i) const { return i < edges.owned; }
};

/// The corners of a cell at rest, m; unused places repeat the first.
inline std::array<Vec3, 4> corners_at_rest(const DistributedMesh& mesh, std::size_t cell) {
  const LocalCell& c = mesh.cells[cell];
  std::array<Vec3, 4> x;
  const Corners2* shape = mesh.rest_shape.empty() ? nullptr : &mesh.rest_shape[cell];
  const bool has_shape = shape && (*shape)[0] != (*shape)[1];
  for (int k = 0; k < 4; ++k) {
    const int corner = k < c.size() ? k : 0;
    x[k] = has_shape ? Vec3((*shape)[corner][0], (*shape)[corner][1], 0)
                     : mesh.rest_positions[c.vertices[corner]];
  }
  return x;
}

/// The constrained edge between two local vertices of which `a` has its star here; -1 if there is none.
inline Local edge_between(const DistributedMesh& mesh, Local a, Local b) {
  for (const EdgeEnd& end : mesh.star_of(a))
    if (end.other == b) return end.edge;
  return -1;
}

/// Of local edges: 1 of sides of quads and of lines, 0 of sides of triangles alone. Collective.
std::vector<char> find_threads(const DistributedMesh& mesh);

/// Of constrained edges at rest, m. Collective.
double mean_edge(const DistributedMesh& mesh);

/// Sends every rank its part. Who needs no hinges may leave them out of `topology`. `owners` are those of the
/// slab's vertices, as `partition` gives them. Collective.
DistributedMesh distribute(MPI_Comm comm, const MeshSlab& mesh, const Topology& topology,
                           const std::vector<int>& owners);

/// The same from the mesh alone, for programs that want neither its topology nor its cut. Collective.
DistributedMesh distribute(MPI_Comm comm, const MeshSlab& mesh, Partitioner method = Partitioner::metis);

} // namespace taut
