#include "src/contact/contact_search.hpp"

#include <algorithm>
#include <numeric>
#include <tuple>
#include <utility>

namespace taut {

namespace {

/// m that planes across the direction between the middles of two features keep them apart; cheaper than their
/// distance, and enough for most pairs.
double separation(PairKind kind, const Four& x) {
  const bool is_edges = kind == PairKind::edge_edge;
  const Vec3 d = is_edges ? Vec3(0.5 * (x[0] + x[1] - x[2] - x[3])) : Vec3(x[0] - (x[1] + x[2] + x[3]) / 3.0);
  const double a = d.dot(x[0]), b = d.dot(x[1]), c = d.dot(x[2]), e = d.dot(x[3]);
  const double room = is_edges ? std::min(a, b) - std::max(c, e) : a - std::max({b, c, e});
  return room > 0 ? room / d.norm() : 0.0;
}

struct Interval {
  double low, high;
};

double apart(const Interval& a, const Interval& b) { return std::max(a.low - b.high, b.low - a.high); }

/// Where an element lies along a direction.
class Extent {
public:
  Extent(const Element& element, std::span<const Vec3> x, const Vec3& direction) {
    for (int k = 0; k < 3; ++k) at_[k] = direction.dot(x[element.vertices[k]]);
  }
  Interval of(int k) const { return {at_[k], at_[k]}; }
  Interval of(int k, int l) const { return {std::min(at_[k], at_[l]), std::max(at_[k], at_[l])}; }
  Interval all() const { return {std::min({at_[0], at_[1], at_[2]}), std::max({at_[0], at_[1], at_[2]})}; }

private:
  std::array<double, 3> at_;
};

/// Which corners of two elements are the same vertex, or sewn together.
struct Shared {
  bool same[3][3] = {};        ///< corner k of the first and l of the second
  int count = 0, k = 0, l = 0; ///< how many, and one of them

  Shared(const Element& a, const std::array<Global, 3>& joints_a, const Element& b,
         const std::array<Global, 3>& joints_b) {
    for (int i = 0; i < a.corners; ++i)
      for (int j = 0; j < b.corners; ++j)
        if (joints_a[i] == joints_b[j]) {
          same[i][j] = true;
          ++count, k = i, l = j;
        }
  }
};

/// m by which the edge from p to q is beyond the triangle (0, r, s), along the direction to its middle.
double beyond(const Vec3& p, const Vec3& q, const Vec3& r, const Vec3& s) {
  const Vec3 n = p + q;
  const double room = std::min(n.dot(p), n.dot(q)) - std::max({0.0, n.dot(r), n.dot(s)});
  return room > 0 ? room / n.norm() : 0.0;
}

/// m that features of two triangles which have no vertex in common are apart, at least, if the triangles have
/// a corner in common: one of two such features is in the edge opposite that corner.
double apart_around(const Shared& shared, const Element& a, const Element& b, std::span<const Vec3> x) {
  const auto from_corner = [&](const Element& e, int corner, int other) {
    return Vec3(x[e.vertices[(corner + other) % 3]] - x[e.vertices[corner]]);
  };
  const Vec3 p = from_corner(a, shared.k, 1), q = from_corner(a, shared.k, 2);
  const Vec3 r = from_corner(b, shared.l, 1), s = from_corner(b, shared.l, 2);
  return std::min(beyond(p, q, r, s), beyond(r, s, p, q));
}

/// Calls visit(kind, vertices, apart) for the pairs of features of two elements that have no vertex in
/// common: vertices against faces both ways, edges against edges, each by the element that represents it. An
/// element without a face has edges only, a point is an edge of no length. `apart` is by how much the
/// features are apart along the direction of the extents.
template<class Visit>
void for_each_feature_pair(const Element& a, const Element& b, const Shared& shared, const Extent& along_a,
                           const Extent& along_b, Visit&& visit) {
  const auto &v = a.vertices, &w = b.vertices;
  const auto& same = shared.same;
  for (int k = 0; b.is_triangle() && k < a.corners; ++k)
    if (a.represents_vertex(k) && !same[k][0] && !same[k][1] && !same[k][2])
      visit(PairKind::vertex_face, {v[k], w[0], w[1], w[2]}, apart(along_a.of(k), along_b.all()));
  for (int l = 0; a.is_triangle() && l < b.corners; ++l)
    if (b.represents_vertex(l) && !same[0][l] && !same[1][l] && !same[2][l])
      visit(PairKind::vertex_face, {w[l], v[0], v[1], v[2]}, apart(along_b.of(l), along_a.all()));
  for (int k = 0; k < a.corners; ++k) {
    if (!a.represents_edge(k) && (a.corners > 1 || b.is_triangle())) continue;
    const int k1 = a.next(k);
    for (int l = 0; l < b.corners; ++l) {
      if (!b.represents_edge(l) && (b.corners > 1 || a.is_triangle())) continue;
      const int l1 = b.next(l);
      if (!same[k][l] && !same[k][l1] && !same[k1][l] && !same[k1][l1])
        visit(PairKind::edge_edge, {v[k], v[k1], w[l], w[l1]}, apart(along_a.of(k, k1), along_b.of(l, l1)));
    }
  }
}

/// Puts pairs in the order of their vertices, places in fields of this size, however they were found.
void put_in_order(std::span<Pair> pairs, std::size_t size) {
  if (pairs.empty()) return;                   // as on one rank across ranks, and often within a step
  std::vector<std::size_t> begin(size + 1, 0); // of those with each first vertex
  for (const Pair& p : pairs) ++begin[p.vertices[0] + 1];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<Pair> ordered(pairs.size());
  std::vector<std::size_t> end = begin;
  for (const Pair& p : pairs) ordered[end[p.vertices[0]]++] = p;
  for (std::size_t v = 0; v < size; ++v)
    std::sort(ordered.begin() + begin[v], ordered.begin() + end[v], [](const Pair& a, const Pair& b) {
      return std::tie(a.vertices, a.kind) < std::tie(b.vertices, b.kind);
    });
  std::copy(ordered.begin(), ordered.end(), pairs.begin());
}

} // namespace

ContactSearch::ContactSearch(const Cloth& cloth, const Obstacles& obstacles, std::span<const Element> strings)
    : cloth_(cloth), obstacles_(obstacles), elements_(cloth, obstacles, strings),
      own_(cloth.mesh.vertices.owned), obstacle_count_(obstacles.vertices()) {}

void ContactSearch::find(const Motion& motion, double reach, double slack) {
  reach_ = reach;
  elements_.find(motion, reach, slack);
  near_ = {};
  plane_held_.assign(obstacles_.planes().size() * own_, false);
  measure_gaps();
  place_in_fields();
}

bool ContactSearch::follow(const Motion& motion) {
  elements_.follow(motion);
  kept_ = near_.found.size();
  const bool was_across = !across_.found.empty();
  measure_gaps();
  const bool is_other = near_.found.size() > kept_ || was_across || !across_.found.empty();
  if (!any_of(cloth_.mesh.comm, is_other)) return false;
  place_in_fields();
  return true;
}

void ContactSearch::measure_gaps() {
  const std::size_t before = near_.found.size(), fields = elements_.vertices().size();
  look_at(elements_.pairs(), near_);
  look_at_planes();
  put_in_order(std::span(near_.found).subspan(before), fields);
  across_ = {};
  look_at(elements_.pairs_across(), across_);
  put_in_order(across_.found, fields);
}

/// Which pairs of elements there are depends on motions before the last `find` too, but those that boxes as
/// tight as can be keep apart are passed over: what is found does not.
void ContactSearch::look_at(std::span<const BoxPair> pairs, Near& near) const {
  near.spare.resize(pairs.size(), 0.0);
  near.held.resize(pairs.size(), 0);
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    double& spare = near.spare[k];
    if (spare > 0) spare -= elements_.strayed(pairs[k]);
    if (spare <= 0 && elements_.meets(pairs[k])) spare = meet(pairs[k], near.held[k], near.found);
  }
}

/// Keeps the pairs of features of two elements that can come within reach, if it does not hold them yet;
/// returns how much more motion (m) it takes to bring another one there, at least.
double ContactSearch::meet(const BoxPair& elements, std::uint16_t& held, std::vector<Pair>& found) const {
  const Element &a = elements_.element(elements.first), &b = elements_.element(elements.second);
  const ElementSearch::Range range = elements_.range(elements);
  const Shared shared(a, elements_.joints(elements.first), b, elements_.joints(elements.second));
  const auto key = [&](Local vertex) { return elements_.vertices()[vertex].key; };
  const bool has_common_corner = shared.count == 1 && key(a.vertices[shared.k]) == key(b.vertices[shared.l]);
  if (has_common_corner && a.is_triangle() && b.is_triangle())
    if (const double spare = apart_around(shared, a, b, elements_.positions()) - range.far; spare > 0)
      return spare;
  const Vec3 across = elements_.direction(elements);
  const Extent along_a(a, elements_.positions(), across), along_b(b, elements_.positions(), across);
  if (const double spare = apart(along_a.all(), along_b.all()) - range.far; spare > 0) return spare;
  const std::int16_t body = std::max(a.body, b.body);
  const double radius = body >= 0 ? obstacles_.body(body).radius : 0.0;
  double least = HUGE_VAL;
  std::uint16_t bit = 1; // of at most six pairs of vertex and face and nine of edges
  for_each_feature_pair(a, b, shared, along_a, along_b,
                        [&](PairKind kind, const std::array<Local, 4>& vertices, double apart_across) {
                          const std::uint16_t mine = std::exchange(bit, bit << 1);
                          if (held & mine) return;
                          const Pair pair{vertices, kind, body, radius, Vec3::Zero()};
                          const double spare = spare_of(pair, range, apart_across);
                          if (spare > 0) {
                            least = std::min(least, spare);
                          } else {
                            found.push_back(pair);
                            held |= mine;
                          }
                        });
  return least;
}

/// How much more motion (m) brings a pair of features within reach, at least. Planes across the direction
/// between the elements tell most features apart, those across the direction between the features most of the
/// others.
double ContactSearch::spare_of(const Pair& pair, const ElementSearch::Range& range,
                               double apart_across) const {
  if (apart_across > range.far) return apart_across - range.far;
  const Four x = at(pair, elements_.positions());
  const double separate = separation(pair.kind, x) - range.far;
  if (separate > 0) return separate;
  const Approach here = approach(pair, x);
  const double approaching = closing_speed(pair, at(pair, elements_.displacements()), here.normal);
  return std::max(here.gap + pair.radius - range.far, here.gap - std::max(0.0, approaching) - range.near);
}

void ContactSearch::look_at_planes() {
  const Local cloth = cloth_.mesh.vertices.size();
  auto held = plane_held_.begin();
  for (const Obstacles::Plane& plane : obstacles_.planes()) {
    const Local point = cloth + plane.point;
    Pair pair{{0, point, point, point},
              PairKind::vertex_plane,
              std::int16_t(plane.body),
              obstacles_.body(plane.body).radius,
              plane.normal};
    for (Local i = 0; i < own_; ++i, ++held) {
      pair.vertices[0] = i;
      const double gap = approach(pair, at(pair, elements_.positions())).gap;
      const double approaching = closing_speed(pair, at(pair, elements_.displacements()), plane.normal);
      if (*held || gap - std::max(0.0, approaching) > reach_) continue;
      near_.found.push_back(pair);
      *held = true;
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
  pairs_ = near_.found;
  pairs_.insert(pairs_.end(), across_.found.begin(), across_.found.end());
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
