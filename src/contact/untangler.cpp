#include "src/contact/untangler.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace taut {

namespace {

constexpr double flattest = 0.05; ///< least |E . N| that is used: an edge along a face would have to move far
constexpr double step = 0.5;      ///< of the thickness, at most, along a curve
constexpr double gentle = 0.1;    ///< size of a push below which it moves less
constexpr double clearance = 0.5; ///< of the thickness, to which cloth leaves a body

/// Barycentric coordinates of a point in the plane of a triangle.
Vec3 barycentric(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 normal = (b - a).cross(c - a);
  const double size = normal.squaredNorm();
  const double v = normal.dot((p - a).cross(c - a)) / size, w = normal.dot((b - a).cross(p - a)) / size;
  return {1 - v - w, v, w};
}

} // namespace

Untangler::Untangler(const Cloth& cloth, const Obstacles& obstacles, const Thickness& thickness)
    : cloth_(cloth), obstacles_(obstacles), thickness_(thickness), elements_(cloth, obstacles),
      search_(cloth, obstacles), has_faces_(obstacles.bodies(), 0) {
  for (const Element& e : obstacles.elements())
    if (e.is_triangle()) has_faces_[e.body] = 1;
}

std::vector<Vec3> Untangler::find(std::span<const Vec3> cloth, std::span<const Vec3> obstacles) {
  pushes_.clear();
  owners_.clear();
  pierced_.clear();
  crossed_.clear();
  elements_.find({cloth, cloth, obstacles, obstacles}, 0.0, 0.0);
  for (const auto pairs : {elements_.pairs(), elements_.pairs_across()})
    for (const auto& [a, b] : pairs) shorten(elements_.element(a), elements_.element(b));
  std::vector<Vec3> moves = moves_along_curves();
  const bool crosses = any_of(cloth_.mesh.comm, !pushes_.empty());
  leave_bodies(cloth, obstacles, leave_solids(obstacles, moves) || crosses, moves);
  return moves;
}

std::optional<Untangler::Piercing> Untangler::pierce(Local from, Local to, const Element& face) const {
  const auto x = elements_.positions();
  const auto& f = face.vertices;
  const Vec3 edge = x[to] - x[from], across = (x[f[1]] - x[f[0]]).cross(x[f[2]] - x[f[0]]);
  const double crossing = edge.dot(across);
  if (crossing == 0) return std::nullopt; // along the face, or no face
  const double t = (x[f[0]] - x[from]).dot(across) / crossing;
  if (!(t >= 0 && t <= 1)) return std::nullopt;
  const Vec3 place = x[from] + t * edge, b = barycentric(place, x[f[0]], x[f[1]], x[f[2]]);
  if (!(b.minCoeff() >= 0)) return std::nullopt;
  return Piercing{{from, to, f[0], f[1], f[2]},
                  {1 - t, t, -b[0], -b[1], -b[2]},
                  place,
                  edge.normalized(),
                  across.normalized()};
}

/// Two triangles cross along a segment between two places where an edge of one pierces the other, or between
/// one and the vertex that they share.
void Untangler::shorten(const Element& a, const Element& b) {
  if (!a.is_triangle() || !b.is_triangle()) return;
  const auto vertices = elements_.vertices();
  std::vector<Piercing> places;
  std::optional<Vec3> shared;
  for (const auto& [edges, face] : {std::pair{&a, &b}, std::pair{&b, &a}})
    for (int k = 0; k < 3; ++k) {
      const Local from = edges->vertices[k], to = edges->edge_end(k);
      bool apart = true;
      for (const Local v : face->vertices) {
        if (vertices[v].key == vertices[from].key) shared = elements_.positions()[v];
        apart = apart && vertices[v].key != vertices[from].key && vertices[v].key != vertices[to].key;
      }
      if (!apart) continue;
      if (const auto p = pierce(from, to, *face)) places.push_back(*p);
    }
  const int body = std::max(a.body, b.body);
  if (body >= 0 && obstacles_.body(body).rims == 0) {
    if (!places.empty()) note(a, body, places);
  } else if (places.size() == 2) {
    push(places[0], places[1].place);
    push(places[1], places[0].place);
  } else if (places.size() == 1 && shared) {
    push(places[0], *shared);
  }
}

void Untangler::push(const Piercing& at, const Vec3& towards) {
  const Vec3 segment = towards - at.place;
  if (segment.norm() == 0) return;
  const Vec3 along = segment.normalized();
  const double steep = at.edge.dot(at.normal);
  const Vec3 direction =
      along - at.edge.dot(along) / std::copysign(std::max(std::abs(steep), flattest), steep) * at.normal;
  for (int i = 0; i < 5; ++i) {
    const SurfaceVertex& v = elements_.vertices()[at.vertices[i]];
    if (v.key >= cloth_.mesh.vertices.total) continue; // of an obstacle
    pushes_.push_back({v.place, std::abs(at.weights[i]), at.weights[i] * direction});
    owners_.push_back(v.owner);
  }
}

/// Where a triangle crosses a closed mesh, and where its edges do.
void Untangler::note(const Element& cloth, int body, std::span<const Piercing> places) {
  Crossing& crossing = crossed_[{body, cloth.vertices}];
  for (const Piercing& p : places) {
    const auto [from, to] = std::minmax(p.vertices[0], p.vertices[1]);
    const bool is_edge_of_cloth = to < cloth_.mesh.vertices.size();
    if (is_edge_of_cloth)
      pierced_[{body, from, to}].push_back(from == p.vertices[0] ? p.weights[1] : p.weights[0]);
    for (int i = is_edge_of_cloth ? 0 : 2; i < (is_edge_of_cloth ? 2 : 5); ++i)
      for (int k = 0; k < 3; ++k)
        if (cloth.vertices[k] == p.vertices[i]) crossing.weights[k] += std::abs(p.weights[i]);
    ++crossing.count;
  }
}

/// The vertices of triangles that cross a closed mesh, the middle of where each crosses it, and the middle
/// between two places where an edge does.
std::vector<Untangler::Place> Untangler::places_within() const {
  std::vector<Place> places;
  for (const auto& [triangle, crossing] : crossed_) {
    const auto& [body, v] = triangle;
    for (int k = 0; k < 3; ++k) places.push_back({v, Vec3::Unit(k), body});
    places.push_back({v, crossing.weights / crossing.count, body});
  }
  for (const auto& [edge, pierced] : pierced_) {
    const auto& [body, from, to] = edge;
    std::vector<double> along = pierced;
    std::sort(along.begin(), along.end());
    for (std::size_t i = 1; i < along.size(); ++i) {
      const double middle = 0.5 * (along[i - 1] + along[i]);
      if (along[i] > along[i - 1]) places.push_back({{from, to, to}, {1 - middle, middle, 0}, body});
    }
  }
  return places;
}

/// By the winding number, the sum of the solid angles of all triangles [Van Oosterom and Strackee 1983].
bool Untangler::is_inside(const Vec3& x, int body, std::span<const Vec3> obstacles) const {
  double angle = 0;
  for (const Element& e : obstacles_.elements()) {
    if (e.body != body) continue;
    const Vec3 a = obstacles[e.vertices[0]] - x, b = obstacles[e.vertices[1]] - x,
               c = obstacles[e.vertices[2]] - x;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    angle += 2 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return std::abs(angle) > 2 * std::numbers::pi; // half of all around
}

Vec3 Untangler::to_surface(const Vec3& x, int body, std::span<const Vec3> obstacles) const {
  Vec3 way = Vec3::Constant(HUGE_VAL);
  for (const Element& e : obstacles_.elements()) {
    if (e.body != body) continue;
    const Closest near = closest_vertex_face(
        {x, obstacles[e.vertices[0]], obstacles[e.vertices[1]], obstacles[e.vertices[2]]});
    if (near.distance < way.norm()) way = -near.offset;
  }
  return way;
}

/// Whether anything is inside a closed mesh. Collective.
bool Untangler::leave_solids(std::span<const Vec3> obstacles, std::vector<Vec3>& moves) {
  const auto x = elements_.positions();
  const double beyond = clearance * thickness_.largest();
  std::vector<Push> ways;
  std::vector<int> owners;
  for (const auto& [vertices, at, body] : places_within()) {
    const Vec3 place = at[0] * x[vertices[0]] + at[1] * x[vertices[1]] + at[2] * x[vertices[2]];
    if (!is_inside(place, body, obstacles)) continue;
    Vec3 way = to_surface(place, body, obstacles);
    way *= 1 + beyond / std::max(way.norm(), 1e-9 * beyond);
    for (int k = 0; k < 3; ++k) {
      if (at[k] == 0) continue;
      const SurfaceVertex& v = elements_.vertices()[vertices[k]];
      ways.push_back({v.place, at[k], at[k] * at[k] / at.squaredNorm() * way});
      owners.push_back(v.owner);
    }
  }
  std::vector<double> weights(moves.size(), 0.0);
  for (const Push& p : exchange(cloth_.mesh.comm, ways, owners).items) {
    if (weights[p.place] == 0) moves[p.place].setZero();
    moves[p.place] += p.direction;
    weights[p.place] += p.weight;
  }
  for (std::size_t i = 0; i < moves.size(); ++i)
    if (weights[i] > 0) moves[i] /= weights[i];
  return any_of(cloth_.mesh.comm, !crossed_.empty());
}

/// The mean of the pushes on each owned vertex, as a move of limited length.
std::vector<Vec3> Untangler::moves_along_curves() {
  std::vector<Vec3> moves(search_.own(), Vec3::Zero());
  std::vector<double> weights(search_.own(), 0.0);
  for (const Push& p : exchange(cloth_.mesh.comm, pushes_, owners_).items) {
    moves[p.place] += p.direction;
    weights[p.place] += p.weight;
  }
  for (std::size_t i = 0; i < moves.size(); ++i) {
    if (weights[i] == 0) continue;
    const Vec3 mean = moves[i] / weights[i];
    moves[i] = step * thickness_.largest() / std::hypot(mean.norm(), gentle) * mean;
  }
  return moves;
}

/// Where a surface crosses that of a body, nothing tells its sides apart: first the curves have to go.
void Untangler::leave_bodies(std::span<const Vec3> cloth, std::span<const Vec3> obstacles, bool crosses,
                             std::vector<Vec3>& moves) {
  search_.find({cloth, cloth, obstacles, obstacles}, 0.0);
  std::vector<Vec3> field;
  search_.gather(cloth, obstacles, field);
  std::vector<Vec3> sums(search_.size(), Vec3::Zero());
  std::vector<double> counts(search_.size(), 0.0);
  for (const Pair& pair : search_.pairs()) {
    if (pair.body < 0 || (crosses && has_faces_[pair.body])) continue;
    const Approach here = approach(pair, at(pair, field));
    if (here.gap >= 0) continue;
    const double violation = clearance * thickness_.of(pair, search_.keys()) - here.gap;
    double size = 0;
    const auto is_body = [&](int i) {
      return pair.vertices[i] >= search_.own() && pair.vertices[i] < search_.home();
    };
    for (int i = 0; i < 4; ++i)
      if (!is_body(i)) size += here.weights[i] * here.weights[i];
    for (int i = 0; i < 4; ++i) {
      if (is_body(i) || here.weights[i] == 0) continue;
      sums[pair.vertices[i]] += here.weights[i] * violation / size * here.normal;
      counts[pair.vertices[i]] += 1;
    }
  }
  search_.accumulate(sums);
  search_.accumulate(counts);
  for (std::size_t i = 0; i < moves.size(); ++i)
    if (counts[i] > 0) moves[i] += sums[i] / counts[i];
}

} // namespace taut
