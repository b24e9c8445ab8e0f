#include "src/contact/contact_search.hpp"

#include <algorithm>

namespace taut {

ContactSearch::ContactSearch(const Cloth& cloth, const Obstacles& obstacles)
    : cloth_(cloth), obstacles_(obstacles), elements_(cloth, obstacles), own_(cloth.mesh.vertices.owned),
      obstacle_count_(obstacles.vertices()) {}

void ContactSearch::find(const Motion& motion, double reach, double slack) {
  reach_ = reach + 2 * slack;
  pairs_.clear();
  elements_.find(motion, reach_);
  elements_.for_each_pair(
      [this](const Element& a, const Element& b, double far) { meet_features(a, b, far); });
  meet_planes();
  place_in_fields();
}

/// Vertices against faces both ways, edges against edges, each by the element that represents it. An element
/// without a face has edges only, a point is an edge of no length.
void ContactSearch::meet_features(const Element& a, const Element& b, double reach) {
  const std::int16_t body = std::max(a.body, b.body);
  if (b.is_triangle())
    for (int k = 0; k < a.corners; ++k)
      if (a.represents_vertex(k))
        try_pair(PairKind::vertex_face, body, {a.vertices[k], b.vertices[0], b.vertices[1], b.vertices[2]},
                 reach);
  if (a.is_triangle())
    for (int k = 0; k < b.corners; ++k)
      if (b.represents_vertex(k))
        try_pair(PairKind::vertex_face, body, {b.vertices[k], a.vertices[0], a.vertices[1], a.vertices[2]},
                 reach);
  for (int k = 0; k < a.corners; ++k)
    if (a.represents_edge(k) || (a.corners == 1 && !b.is_triangle()))
      for (int l = 0; l < b.corners; ++l)
        if (b.represents_edge(l) || (b.corners == 1 && !a.is_triangle()))
          try_pair(PairKind::edge_edge, body, {a.vertices[k], a.edge_end(k), b.vertices[l], b.edge_end(l)},
                   reach);
}

/// Keeps the pair if nothing shows that it stays apart: vertices in common, balls around its features, their
/// distance, the motion along the direction of that.
void ContactSearch::try_pair(PairKind kind, std::int16_t body, const std::array<Local, 4>& v, double reach) {
  const auto vertices = elements_.vertices();
  const bool is_edges = kind == PairKind::edge_edge;
  for (int i = 0; i < (is_edges ? 2 : 1); ++i)
    for (int k = is_edges ? 2 : 1; k < 4; ++k)
      if (vertices[v[i]].key == vertices[v[k]].key) return;
  const Pair pair{v, kind, body, body >= 0 ? obstacles_.body(body).radius : 0.0, Vec3::Zero()};
  const Four x = at(pair, elements_.positions());
  if (is_edges) {
    const double far = reach + 0.5 * ((x[1] - x[0]).norm() + (x[3] - x[2]).norm());
    if (0.25 * (x[0] + x[1] - x[2] - x[3]).squaredNorm() > far * far) return;
  }
  const Approach here = approach(pair, x);
  if (here.gap + pair.radius > reach) return;
  const double approaching = closing(pair, at(pair, elements_.displacements()), here.normal);
  if (here.gap - std::max(0.0, approaching) <= reach_) pairs_.push_back(pair);
}

void ContactSearch::meet_planes() {
  const Local cloth = cloth_.mesh.vertices.size();
  for (const Obstacles::Plane& plane : obstacles_.planes()) {
    const Local point = cloth + plane.point;
    Pair pair{{0, point, point, point},
              PairKind::vertex_plane,
              std::int16_t(plane.body),
              obstacles_.body(plane.body).radius,
              plane.normal};
    for (Local i = 0; i < own_; ++i) {
      pair.vertices[0] = i;
      const double gap = approach(pair, at(pair, elements_.positions())).gap;
      const double approaching = closing(pair, at(pair, elements_.displacements()), plane.normal);
      if (gap - std::max(0.0, approaching) <= reach_) pairs_.push_back(pair);
    }
  }
}

/// Renumbers the vertices of the pairs to places in contact fields, and arranges for their ghosts.
void ContactSearch::place_in_fields() {
  const MPI_Comm comm = cloth_.mesh.comm;
  const int me = rank_of(comm);
  const auto vertices = elements_.vertices();
  const auto before = [](const SurfaceVertex& a, const SurfaceVertex& b) {
    return std::pair(a.owner, a.place) < std::pair(b.owner, b.place);
  };
  std::vector<SurfaceVertex> ghosts;
  for (const Pair& p : pairs_)
    for (const Local v : p.vertices)
      if (vertices[v].owner != me) ghosts.push_back(vertices[v]);
  std::sort(ghosts.begin(), ghosts.end(), before);
  ghosts.erase(std::unique(ghosts.begin(), ghosts.end(),
                           [](const SurfaceVertex& a, const SurfaceVertex& b) {
                             return a.owner == b.owner && a.place == b.place;
                           }),
               ghosts.end());
  for (Pair& p : pairs_)
    for (Local& v : p.vertices) {
      const SurfaceVertex& vertex = vertices[v];
      v = vertex.owner == me ? vertex.place
                             : home() + Local(std::lower_bound(ghosts.begin(), ghosts.end(), vertex, before) -
                                              ghosts.begin());
    }

  keys_.resize(home());
  for (Local i = 0; i < own_; ++i) keys_[i] = vertices[i].key;
  for (Local k = 0; k < obstacle_count_; ++k) keys_[own_ + k] = cloth_.mesh.vertices.total + k;
  std::vector<Local> wanted, arrivals;
  std::vector<int> owners, askers;
  for (const SurfaceVertex& g : ghosts) {
    arrivals.push_back(Local(keys_.size()));
    keys_.push_back(g.key);
    wanted.push_back(g.place);
    owners.push_back(g.owner);
  }
  const auto asked = exchange(comm, wanted, owners);
  for (int r = 0; r < size_of(comm); ++r)
    askers.insert(askers.end(), std::size_t(asked.offsets[r + 1] - asked.offsets[r]), r);
  plan_ = Plan(comm, askers, asked.items, std::move(arrivals));
}

void ContactSearch::gather(std::span<const Vec3> cloth, std::span<const Vec3> obstacles,
                           std::vector<Vec3>& field) const {
  field.resize(size());
  std::copy(cloth.begin(), cloth.begin() + own_, field.begin());
  std::copy(obstacles.begin(), obstacles.end(), field.begin() + own_);
  update(field);
}

} // namespace taut
