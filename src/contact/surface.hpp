#pragma once
#include "partition/distributed_mesh.hpp"

namespace taut {

/// What collides: a triangle, or a segment or a point of something thinner. Vertices and edges that several
/// elements share are represented by one of them, so that every pair of features is met once [Curtis,
/// Tamstorf, Manocha 2008, representative triangles].
struct Element {
  std::array<Local, 3> vertices; ///< beyond `corners` the first again
  std::int8_t corners;
  std::uint8_t represents; ///< bit k: vertex k; bit 3 + k: edge k, from vertex k to the next
  std::int16_t body;       ///< the obstacle; -1 for cloth, `string` for what closes a seam

  static constexpr std::int16_t string = -2;
  bool is_string() const { return body == string; }

  bool represents_vertex(int k) const { return represents >> k & 1; }
  bool represents_edge(int k) const { return represents >> (3 + k) & 1; }
  bool is_triangle() const { return corners == 3; }
  int next(int k) const { return k + 1 < corners ? k + 1 : 0; }
  Local edge_end(int k) const { return vertices[next(k)]; }
};

/// The elements of the cells that this rank owns, vertices in local numbers: quads are cut along the diagonal
/// from their first vertex, lines are segments. Every vertex and every edge of the cloth (diagonals too) is
/// represented on exactly one rank, by an element that does not depend on the partition. In the order of the
/// elements' first vertices, which lie along a space-filling curve. Collective.
std::vector<Element> cloth_elements(const DistributedMesh& mesh);

} // namespace taut
