#pragma once
#include "src/state/cloth.hpp"

namespace taut {

/// The metric of a cloth of triangles along warp and weft, |w_u|^2 and |w_v|^2 [BW98 eq. 9], averaged around
/// each vertex with the areas of its triangles: two numbers a vertex, 1 at rest. To keep them is to keep two
/// lengths a vertex, as warp and weft of quads do; all edges of a triangle mesh are three, which lock it.
///
/// On a triangle with the material coordinates m, an edge with dm = (u, v) has |d|^2 = u^2 g_uu + 2 u v g_uv
/// + v^2 g_vv. So the metric is linear in the squared lengths of the edges, with weights from the rest shape,
/// and so is its average.
class AveragedMetric {
public:
  /// Warp and weft, in that order.
  using Pair = Vec2;

  /// What an edge adds to the average at a vertex, for each of its squared length.
  struct Share {
    Local vertex, edge;
    Pair weight; ///< 1/m^2
  };

  /// `cloth` must outlive the metric and have no faces but triangles. Not collective.
  explicit AveragedMetric(const Cloth& cloth);

  /// All shares at an owned vertex.
  std::span<const Share> of_vertex(Local vertex) const {
    return {by_vertex_.data() + vertex_begin_[vertex], vertex_begin_[vertex + 1] - vertex_begin_[vertex]};
  }
  /// Those of an edge, at the corners of its triangles: of all edges around owned vertices.
  std::span<const Share> of_edge(Local edge) const {
    return {by_edge_.data() + edge_begin_[edge], edge_begin_[edge + 1] - edge_begin_[edge]};
  }

  /// At an owned vertex. Not collective.
  Pair at(Local vertex, std::span<const Vec3> positions) const;

  const Cloth& cloth() const { return cloth_; }

private:
  const Cloth& cloth_;
  std::vector<Share> by_vertex_, by_edge_;
  std::vector<std::size_t> vertex_begin_, edge_begin_;
};

} // namespace taut
