#pragma once
#include "src/state/cloth.hpp"

namespace taut {

/// The metric of the triangles of a cloth along warp and weft, |w_u|^2 and |w_v|^2 [BW98 eq. 9], averaged
/// around each of their corners with their areas: two numbers a vertex, 1 at rest. To keep them is to keep
/// two lengths a vertex, as warp and weft of quads do; all edges of a triangle mesh are three, which lock it.
///
/// Corners that triangles share with quads are left out: the sides of quads, which are kept, are nearly two
/// lengths a vertex there already. (With averages there too, a disc of quads within triangles that hung by
/// two patches gained energy until no step was found.)
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

  /// `cloth` must outlive the metric; its mesh has the sides of triangles as edges (ConstrainedEdges::all).
  /// Collective.
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

  /// What values of local vertices, times their scale, are by the squared length of an edge: the sum of
  /// scale w value over its shares. Edges as in `of_edge`. Not collective.
  double on_edge(Local edge, std::span<const double> scale, std::span<const Pair> values) const;

  /// Whether a local vertex is a corner of triangles and of no quad, and so has a metric.
  bool has(Local vertex) const { return area_[vertex] > 0; }
  /// m^2 of triangles that belong to a local vertex: a third of each.
  double area(Local vertex) const { return area_[vertex]; }
  std::span<const double> areas() const { return area_; }

  const Cloth& cloth() const { return cloth_; }

private:
  const Cloth& cloth_;
  std::vector<double> area_;
  std::vector<Share> by_vertex_, by_edge_;
  std::vector<std::size_t> vertex_begin_, edge_begin_;
};

} // namespace taut
