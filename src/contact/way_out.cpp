#include "src/contact/way_out.hpp"

#include <Eigen/Geometry>

#include <cmath>

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

WayOut::WayOut(const Cloth& cloth, const Obstacles& obstacles, const Thickness& thickness)
    : cloth_(cloth), thickness_(thickness), elements_(cloth, obstacles), search_(cloth, obstacles),
      has_faces_(obstacles.bodies(), 0) {
  for (const Element& e : obstacles.elements())
    if (e.is_triangle()) has_faces_[e.body] = 1;
}

std::vector<Vec3> WayOut::find(std::span<const Vec3> cloth, std::span<const Vec3> obstacles) {
  pushes_.clear();
  owners_.clear();
  elements_.find({cloth, cloth, obstacles, obstacles}, 0.0);
  elements_.for_each_pair([this](const Element& a, const Element& b, double) { shorten(a, b); });
  std::vector<Vec3> moves = moves_along_curves();
  leave_bodies(cloth, obstacles, moves);
  return moves;
}

std::optional<WayOut::Piercing> WayOut::pierce(Local from, Local to, const Element& face) const {
  const auto x = elements_.positions();
  const auto& f = face.vertices;
  const Vec3 edge = x[to] - x[from], across = (x[f[1]] - x[f[0]]).cross(x[f[2]] - x[f[0]]);
  const double closing = edge.dot(across);
  if (closing == 0) return std::nullopt; // along the face, or no face
  const double t = (x[f[0]] - x[from]).dot(across) / closing;
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
void WayOut::shorten(const Element& a, const Element& b) {
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
  if (places.size() == 2) {
    push(places[0], places[1].place);
    push(places[1], places[0].place);
  } else if (places.size() == 1 && shared) {
    push(places[0], *shared);
  }
}

void WayOut::push(const Piercing& at, const Vec3& towards) {
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

/// The mean of the pushes on each owned vertex, as a move of limited length.
std::vector<Vec3> WayOut::moves_along_curves() {
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
void WayOut::leave_bodies(std::span<const Vec3> cloth, std::span<const Vec3> obstacles,
                          std::vector<Vec3>& moves) {
  const bool crosses = any_of(cloth_.mesh.comm, !pushes_.empty());
  search_.find({cloth, cloth, obstacles, obstacles}, 0.0, 0.0);
  std::vector<Vec3> field;
  search_.gather(cloth, obstacles, field);
  std::vector<Vec3> sums(search_.size(), Vec3::Zero()), counts = sums; // the first component counts
  for (const Pair& pair : search_.pairs()) {
    if (pair.body < 0 || (crosses && has_faces_[pair.body])) continue;
    const Approach here = approach(pair, at(pair, field));
    if (here.gap >= 0) continue;
    const double missing = clearance * thickness_.of(pair, search_.keys()) - here.gap;
    double size = 0;
    const auto is_body = [&](int i) {
      return pair.vertices[i] >= search_.own() && pair.vertices[i] < search_.home();
    };
    for (int i = 0; i < 4; ++i)
      if (!is_body(i)) size += here.weights[i] * here.weights[i];
    for (int i = 0; i < 4; ++i) {
      if (is_body(i) || here.weights[i] == 0) continue;
      sums[pair.vertices[i]] += here.weights[i] * missing / size * here.normal;
      counts[pair.vertices[i]][0] += 1;
    }
  }
  search_.accumulate(sums);
  search_.accumulate(counts);
  for (std::size_t i = 0; i < moves.size(); ++i)
    if (counts[i][0] > 0) moves[i] += sums[i] / counts[i][0];
}

} // namespace taut
