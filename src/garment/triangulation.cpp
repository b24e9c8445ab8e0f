#include "src/garment/triangulation.hpp"

#include "src/garment/plane.hpp"

#include <algorithm>
#include <cmath>

namespace taut::garment {

namespace {

/// Twice the area.
double area_of(const Vec2& a, const Vec2& b, const Vec2& c) { return cross(b - a, c - a); }

/// What two opposite angles must exceed a half turn by, as a sine, for their edge to be flipped: four points
/// on a circle, as those of a lattice are, would be flipped to and fro for ever by rounding alone.
constexpr double on_a_circle = 1e-9;

/// The angles at `a` and `c`, opposite to the diagonal b-d of the quadrilateral a b c d, together exceed pi.
bool exceeds_half_turn(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  const Vec2 ab = b - a, ad = d - a, cb = b - c, cd = d - c;
  const double sine = cross(ab, ad) * cd.dot(cb) + ab.dot(ad) * cross(cd, cb);
  return sine <
         -on_a_circle * std::sqrt(ab.squaredNorm() * ad.squaredNorm() * cb.squaredNorm() * cd.squaredNorm());
}

} // namespace

double smallest_angle(const Vec2& a, const Vec2& b, const Vec2& c) {
  const double la = (c - b).squaredNorm(), lb = (a - c).squaredNorm(), lc = (b - a).squaredNorm();
  const Vec2 &tip = la <= lb && la <= lc ? a
                    : lb <= lc           ? b
                                         : c,
             &one = &tip == &a   ? b
                    : &tip == &b ? c
                                 : a,
             &two = &tip == &a   ? c
                    : &tip == &b ? a
                                 : b;
  return std::atan2(cross(one - tip, two - tip), (one - tip).dot(two - tip));
}

Triangulation::Triangulation(std::vector<Vec2> points, std::span<const std::array<int, 3>> triangles)
    : points_(std::move(points)), triangle_of_(points_.size(), -1), given_(int(points_.size())) {
  for (const auto& t : triangles) triangles_.push_back({t});
  link_neighbours();
}

double Triangulation::angle(int triangle) const {
  const auto& v = triangles_[triangle].vertices;
  return smallest_angle(points_[v[0]], points_[v[1]], points_[v[2]]);
}

void Triangulation::link_neighbours() {
  struct Half {
    int low, high, triangle, side;
  };
  std::vector<Half> halves;
  for (int t = 0; t < int(triangles_.size()); ++t)
    for (int k = 0; k < 3; ++k) {
      const int a = triangles_[t].vertices[(k + 1) % 3], b = triangles_[t].vertices[(k + 2) % 3];
      halves.push_back({std::min(a, b), std::max(a, b), t, k});
      triangle_of_[a] = t;
    }
  std::sort(halves.begin(), halves.end(), [](const Half& x, const Half& y) {
    return std::tie(x.low, x.high, x.triangle) < std::tie(y.low, y.high, y.triangle);
  });
  for (std::size_t i = 0; i + 1 < halves.size(); ++i) {
    const Half &one = halves[i], &two = halves[i + 1];
    if (one.low != two.low || one.high != two.high) continue;
    triangles_[one.triangle].neighbours[one.side] = two.triangle;
    triangles_[two.triangle].neighbours[two.side] = one.triangle;
  }
}

bool Triangulation::flip_if_better(int t, int k, std::vector<std::pair<int, int>>& next) {
  const int u = triangles_[t].neighbours[k];
  if (u < 0) return false;
  Triangle &one = triangles_[t], &two = triangles_[u];
  const int m = int(std::find(two.neighbours.begin(), two.neighbours.end(), t) - two.neighbours.begin());
  const int a = one.vertices[k], b = one.vertices[(k + 1) % 3], c = two.vertices[m],
            d = one.vertices[(k + 2) % 3];
  const Vec2 &pa = points_[a], &pb = points_[b], &pc = points_[c], &pd = points_[d];
  if (!exceeds_half_turn(pa, pb, pc, pd) || area_of(pa, pb, pc) <= 0 || area_of(pa, pc, pd) <= 0)
    return false;
  // b-d becomes a-c: `one` is a b c and `two` a c d.
  const int ab = one.neighbours[(k + 2) % 3], da = one.neighbours[(k + 1) % 3],
            bc = two.neighbours[(m + 1) % 3], cd = two.neighbours[(m + 2) % 3];
  const auto relink = [&](int outside, int from, int to) {
    if (outside < 0) return;
    auto& n = triangles_[outside].neighbours;
    *std::find(n.begin(), n.end(), from) = to;
  };
  one = {{a, b, c}, {bc, u, ab}};
  two = {{a, c, d}, {cd, da, t}};
  relink(bc, u, t);
  relink(da, t, u);
  triangle_of_[a] = triangle_of_[b] = triangle_of_[c] = t;
  triangle_of_[d] = u;
  next.insert(next.end(), {{t, 0}, {t, 2}, {u, 0}, {u, 1}});
  return true;
}

void Triangulation::settle(std::vector<std::pair<int, int>>& suspects) {
  while (!suspects.empty()) {
    const auto [triangle, side] = suspects.back();
    suspects.pop_back();
    flip_if_better(triangle, side, suspects);
  }
}

void Triangulation::make_delaunay() {
  std::vector<std::pair<int, int>> suspects;
  for (int t = int(triangles_.size()); t-- > 0;)
    for (int k = 0; k < 3; ++k) suspects.emplace_back(t, k);
  settle(suspects);
}

int Triangulation::side_towards(int triangle, const Vec2& point) const {
  const auto& v = triangles_[triangle].vertices;
  int worst = -1;
  double farthest =
      1e-12; // in lengths of the side: a point on it may be outside of both triangles by rounding
  for (int k = 0; k < 3; ++k) {
    const Vec2 &a = points_[v[(k + 1) % 3]], &b = points_[v[(k + 2) % 3]];
    const double outside = -area_of(a, b, point) / (b - a).squaredNorm();
    if (outside > farthest) farthest = outside, worst = k;
  }
  return worst;
}

std::optional<int> Triangulation::locate(const Vec2& point, int t) const {
  for (std::size_t steps = 0; steps < triangles_.size(); ++steps) {
    const int side = side_towards(t, point);
    if (side < 0) return t;
    t = triangles_[t].neighbours[side];
    if (t < 0) return std::nullopt;
  }
  return std::nullopt;
}

bool Triangulation::circle_holds(int triangle, const Vec2& point) const {
  const auto& v = triangles_[triangle].vertices;
  Vec2 a = points_[v[0]] - point, b = points_[v[1]] - point, c = points_[v[2]] - point;
  const double aa = a.squaredNorm(), bb = b.squaredNorm(), cc = c.squaredNorm();
  const double inside = aa * cross(b, c) + bb * cross(c, a) + cc * cross(a, b);
  return inside > on_a_circle * std::max({aa, bb, cc}) * std::sqrt(std::max({aa * bb, bb * cc, cc * aa}));
}

Triangulation::Cavity Triangulation::surround(const Vec2& point, std::vector<int> triangles) const {
  Cavity cavity{std::move(triangles), {}, 10, 10};
  const auto is_part = [&](int t) {
    return std::ranges::find(cavity.triangles, t) != cavity.triangles.end();
  };
  for (const int t : cavity.triangles) {
    cavity.angle_before = std::min(cavity.angle_before, angle(t));
    for (int k = 0; k < 3; ++k) {
      const int n = triangles_[t].neighbours[k];
      if (n >= 0 && is_part(n)) continue;
      const int a = triangles_[t].vertices[(k + 1) % 3], b = triangles_[t].vertices[(k + 2) % 3];
      int back = 0;
      while (n >= 0 && triangles_[n].neighbours[back] != t) ++back;
      cavity.hull.push_back({a, b, n, back});
      cavity.angle_after = std::min(cavity.angle_after, smallest_angle(points_[a], points_[b], point));
    }
  }
  return cavity;
}

std::optional<Triangulation::Cavity> Triangulation::cavity_of(const Vec2& point, int start) const {
  const auto home = locate(point, start);
  if (!home) return std::nullopt;
  std::vector<int> triangles{*home};
  for (std::size_t i = 0; i < triangles.size(); ++i)
    for (const int n : triangles_[triangles[i]].neighbours)
      if (n >= 0 && std::ranges::find(triangles, n) == triangles.end() && circle_holds(n, point))
        triangles.push_back(n);
  return surround(point, std::move(triangles));
}

void Triangulation::fill(const Cavity& cavity, const Vec2& point) {
  const int p = int(points_.size());
  points_.push_back(point);
  triangle_of_.push_back(cavity.triangles[0]);
  std::vector<int> places = cavity.triangles;
  while (places.size() < cavity.hull.size()) {
    places.push_back(int(triangles_.size()));
    triangles_.emplace_back();
  }
  for (std::size_t i = 0; i < cavity.hull.size(); ++i) {
    const auto& [a, b, beyond, back] = cavity.hull[i];
    Triangle& made = triangles_[places[i]];
    made = {{a, b, p}, {-1, -1, beyond}};
    if (beyond >= 0) triangles_[beyond].neighbours[back] = places[i];
    triangle_of_[a] = places[i];
    for (std::size_t j = 0; j < cavity.hull.size(); ++j) {
      if (cavity.hull[j].a == b) made.neighbours[0] = places[j];
      if (cavity.hull[j].b == a) made.neighbours[1] = places[j];
    }
  }
}

bool Triangulation::insert(const Vec2& point, double target) {
  int home = int(triangles_.size()) - 1; // perhaps beside the point before
  if (!locate(point, home))              // a hole lies between
    for (home = 0; home < int(triangles_.size()) && side_towards(home, point) >= 0;) ++home;
  if (home == int(triangles_.size())) return false;
  const auto cavity = cavity_of(point, home);
  if (!cavity || cavity->angle_after <= 0 || cavity->angle_after < std::min(target, cavity->angle_before))
    return false;
  fill(*cavity, point);
  return true;
}

std::vector<int> Triangulation::star_of(int vertex) const {
  std::vector<int> star;
  int t = triangle_of_[vertex];
  do {
    star.push_back(t);
    const auto& v = triangles_[t].vertices;
    const auto k = std::find(v.begin(), v.end(), vertex) - v.begin();
    t = triangles_[t].neighbours[(k + 1) % 3];
  } while (t != star.front());
  return star;
}

} // namespace taut::garment
