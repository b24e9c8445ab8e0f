#include "src/constraints/averaged_metric.hpp"

#include "src/state/material_coordinates.hpp"

#include <Eigen/LU>

#include <algorithm>

namespace taut {

namespace {

using Share = AveragedMetric::Share;

constexpr std::array<std::array<int, 2>, 3> sides{{{0, 1}, {1, 2}, {2, 0}}};

double area_of(const Corners2& m) {
  const Vec2 one = m[1] - m[0], two = m[2] - m[0];
  return 0.5 * std::abs(one[0] * two[1] - two[0] * one[1]);
}

/// g_uu and g_vv of a triangle, as weights of the squared lengths of its sides.
std::array<Vec2, 3> weights_of(const Corners2& m) {
  Mat3 squares; // of the sides, from (g_uu, g_uv, g_vv)
  for (int s = 0; s < 3; ++s) {
    const Vec2 d = m[sides[s][1]] - m[sides[s][0]];
    squares.row(s) << d[0] * d[0], 2 * d[0] * d[1], d[1] * d[1];
  }
  const Mat3 inverse = squares.inverse();
  return {Vec2(inverse(0, 0), inverse(2, 0)), Vec2(inverse(0, 1), inverse(2, 1)),
          Vec2(inverse(0, 2), inverse(2, 2))};
}

/// Shares that meet add up; sorted by the number that `key` gives, offsets alike.
template<class Key>
std::vector<std::size_t> sort_by(std::vector<Share>& shares, Local keys, const Key& key) {
  std::stable_sort(shares.begin(), shares.end(),
                   [&](const Share& a, const Share& b) { return key(a) < key(b); });
  std::vector<std::size_t> begin(keys + 1, 0);
  for (const Share& s : shares) ++begin[key(s) + 1];
  for (Local k = 0; k < keys; ++k) begin[k + 1] += begin[k];
  return begin;
}

/// Both triangles of an edge give it a share at each of its ends.
std::vector<Share> added_up(const std::vector<Share>& shares, std::span<const std::size_t> edge_begin) {
  std::vector<Share> sums;
  for (std::size_t e = 0; e + 1 < edge_begin.size(); ++e) {
    const auto first = std::ptrdiff_t(sums.size());
    for (std::size_t k = edge_begin[e]; k < edge_begin[e + 1]; ++k) {
      const auto same = std::find_if(sums.begin() + first, sums.end(),
                                     [&](const Share& s) { return s.vertex == shares[k].vertex; });
      if (same == sums.end())
        sums.push_back(shares[k]);
      else
        same->weight += shares[k].weight;
    }
  }
  return sums;
}

/// Calls `visit(number, material coordinates)`.
template<class Visit>
void for_each_triangle(const DistributedMesh& mesh, Visit&& visit) {
  for (std::size_t c = 0; c < mesh.cells.size(); ++c)
    if (mesh.cells[c].size() == 3) visit(c, material_coordinates(mesh, c));
}

} // namespace

AveragedMetric::AveragedMetric(const Cloth& cloth) : cloth_(cloth), area_(cloth.mesh.vertices.size()) {
  const DistributedMesh& mesh = cloth.mesh;
  for_each_triangle(mesh, [&](std::size_t c, const Corners2& m) {
    for (int k = 0; k < 3; ++k) area_[mesh.cells[c].vertices[k]] += area_of(m) / 3;
  });
  for (const LocalCell& c : mesh.cells)
    for (int k = 0; k < 4 && c.size() == 4; ++k) area_[c.vertices[k]] = 0;
  mesh.vertex_halo.update(area_);
  std::vector<Share> shares;
  for_each_triangle(mesh, [&](std::size_t c, const Corners2& m) {
    const auto& v = mesh.cells[c].vertices;
    const auto weights = weights_of(m);
    for (int s = 0; s < 3; ++s) {
      const Local edge = edge_between(mesh, v[sides[s][0]], v[sides[s][1]]);
      for (int k = 0; k < 3 && edge >= 0; ++k)
        if (has(v[k])) shares.push_back({v[k], edge, area_of(m) / (3 * area_[v[k]]) * weights[s]});
    }
  });
  const auto by_edge = [](const Share& s) { return s.edge; };
  const auto by_vertex = [](const Share& s) { return s.vertex; };
  by_edge_ = added_up(shares, sort_by(shares, mesh.edges.size(), by_edge));
  edge_begin_ = sort_by(by_edge_, mesh.edges.size(), by_edge);
  by_vertex_ = by_edge_;
  vertex_begin_ = sort_by(by_vertex_, mesh.vertices.size(), by_vertex);
}

AveragedMetric::Pair AveragedMetric::at(Local vertex, std::span<const Vec3> positions) const {
  Pair metric = Pair::Zero();
  for (const Share& s : of_vertex(vertex)) {
    const auto& [a, b] = cloth_.mesh.edge_vertices[s.edge];
    metric += s.weight * (positions[b] - positions[a]).squaredNorm();
  }
  return metric;
}

double AveragedMetric::on_edge(Local edge, std::span<const double> scale,
                               std::span<const Pair> values) const {
  double sum = 0;
  for (const Share& s : of_edge(edge)) sum += scale[s.vertex] * s.weight.dot(values[s.vertex]);
  return sum;
}

} // namespace taut
