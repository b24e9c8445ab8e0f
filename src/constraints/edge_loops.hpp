#pragma once
#include "partition/distributed_mesh.hpp"

/// What all sets of constraints share. Their values are functions of the squared lengths |d|^2 of edges, so
/// their derivatives go through those of edges: g = f d by the second vertex of an edge, -g by its first,
/// with a factor f of each edge. The loops are inlined where they are used. Nothing here is collective.
namespace taut {

/// sum_e of (+-) values[e] g[e] over the edges at a vertex: what J^T makes of them there.
inline Vec3 sum_at(const DistributedMesh& mesh, Local vertex, std::span<const Vec3> gradients,
                   std::span<const double> values) {
  Vec3 sum = Vec3::Zero();
  for (const EdgeEnd& end : mesh.star_of(vertex)) sum += end.sign * values[end.edge] * gradients[end.edge];
  return sum;
}

/// field -= J^T values, on owned vertices, which come first in it; `values` of local edges.
inline void subtract_spread(const DistributedMesh& mesh, std::span<const Vec3> gradients,
                            std::span<const double> values, std::span<Vec3> field) {
  const Local own = mesh.vertices.owned;
  for (std::size_t e = 0; e < values.size(); ++e) {
    const auto& [a, b] = mesh.edge_vertices[e];
    const Vec3 pull = values[e] * gradients[e];
    if (a < own) field[a] += pull;
    if (b < own) field[b] -= pull;
  }
}

/// (J u) of an edge.
inline double difference(const DistributedMesh& mesh, std::span<const Vec3> gradients,
                         std::span<const Vec3> u, std::size_t edge) {
  const auto& [a, b] = mesh.edge_vertices[edge];
  return gradients[edge].dot(u[b] - u[a]);
}

} // namespace taut
