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
  elements_.for_each_pair([this](const Element& a, const Element& b) { meet_features(a, b); });
  meet_planes();
  place_in_fields();
}

/// Vertices against faces both ways, edges against edges, each by the element that represents it. An element
/// without a face has edges only, a point is an edge of no length.
void ContactSearch::meet_features(const Element& a, const Element& b) {
  if (b.is_triangle())
    for (int k = 0; k < a.corners; ++k)
      if (a.represents_vertex(k)) try_vertex_face(a, k, b);
  if (a.is_triangle())
    for (int k = 0; k < b.corners; ++k)
      if (b.represents_vertex(k)) try_vertex_face(b, k, a);
  for (int k = 0; k < a.corners; ++k)
    if (a.represents_edge(k) || (a.corners == 1 && !b.is_triangle())) try_edges(a, k, b);
}

void ContactSearch::try_vertex_face(const Element& a, int corner, const Element& b) {
  try_pair({{a.vertices[corner], b.vertices[0], b.vertices[1], b.vertices[2]},
            PairKind::vertex_face,
            std::max(a.body, b.body),
            0.0,
            Vec3::Zero()});
}

void ContactSearch::try_edges(const Element& a, int edge, const Element& b) {
  for (int k = 0; k < b.corners; ++k)
    if (b.represents_edge(k) || (b.corners == 1 && !a.is_triangle()))
      try_pair({{a.vertices[edge], a.edge_end(edge), b.vertices[k], b.edge_end(k)},
                PairKind::edge_edge,
                std::max(a.body, b.body),
                0.0,
                Vec3::Zero()});
}

/// Keeps the pair if nothing shows that it stays farther apart than `reach_`: not the balls around its
/// features, nor the direction of their distance.
void ContactSearch::try_pair(Pair pair) {
  const auto& v = pair.vertices;
  const auto vertices = elements_.vertices();
  const bool is_face = pair.kind == PairKind::vertex_face;
  const Global first = vertices[v[0]].key, second = is_face ? first : vertices[v[1]].key;
  for (int k = is_face ? 1 : 2; k < 4 && pair.kind != PairKind::vertex_plane; ++k)
    if (vertices[v[k]].key == first || vertices[v[k]].key == second) return;
  if (pair.body >= 0) pair.radius = obstacles_.body(pair.body).radius;
  const Four x = at(pair, elements_.positions()), u = at(pair, elements_.displacements());
  const Approach here = approach(pair, x);
  if (here.gap - std::max(0.0, closing(pair, u, here.normal)) <= reach_) pairs_.push_back(pair);
}

void ContactSearch::meet_planes() {
  const Local cloth = cloth_.mesh.vertices.size();
  for (const Obstacles::Plane& plane : obstacles_.planes())
    for (Local i = 0; i < own_; ++i)
      try_pair({{i, cloth + plane.point, cloth + plane.point, cloth + plane.point},
                PairKind::vertex_plane,
                std::int16_t(plane.body),
                0.0,
                plane.normal});
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
