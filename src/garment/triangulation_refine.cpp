#include "src/garment/triangulation.hpp"

#include <algorithm>
#include <cmath>

namespace taut::garment {

namespace {

constexpr double least_gain = 0.01; ///< rad: what an angle must grow by for a point to be put or moved
constexpr int most_rounds = 30;

Vec2 circumcentre(const Vec2& a, const Vec2& b, const Vec2& c) {
  const Vec2 u = b - a, v = c - a;
  const double twice = 2 * (u[0] * v[1] - u[1] * v[0]), uu = u.squaredNorm(), vv = v.squaredNorm();
  return a + Vec2(v[1] * uu - u[1] * vv, u[0] * vv - v[0] * uu) / twice;
}

} // namespace

bool Triangulation::split(int t, double target) {
  const auto& v = triangles_[t].vertices;
  int k = 0; // opposite to the shortest side
  const auto side = [&](int i) { return Vec2(points_[v[(i + 2) % 3]] - points_[v[(i + 1) % 3]]); };
  for (const int i : {1, 2})
    if (side(i).squaredNorm() < side(k).squaredNorm()) k = i;
  const Vec2 middle = (points_[v[(k + 1) % 3]] + points_[v[(k + 2) % 3]]) / 2;
  const Vec2 way = circumcentre(points_[v[0]], points_[v[1]], points_[v[2]]) - middle;
  if (!way.allFinite() || way.squaredNorm() == 0) return false;
  // From an off-centre the shortest side is seen under the angle asked for.
  const double off_centre = std::min(1.0, side(k).norm() / (2 * std::tan(target / 2)) / way.norm());
  std::optional<Cavity> best;
  Vec2 place;
  for (const double part : {off_centre, 1.0, 0.75 * off_centre, 0.5 * off_centre}) {
    const Vec2 point = middle + part * way;
    auto cavity = cavity_of(point, t);
    if (!cavity || std::ranges::find(cavity->triangles, t) == cavity->triangles.end()) continue;
    if (cavity->angle_after < std::min(target, cavity->angle_before + least_gain)) continue;
    if (best && best->angle_after >= std::min(target, cavity->angle_after)) continue;
    best = std::move(cavity);
    place = point;
  }
  if (best) fill(*best, place);
  return best.has_value();
}

int Triangulation::insert_where_sharp(double target) {
  int inserted = 0;
  for (int round = 0; round < most_rounds; ++round) {
    const int before = inserted;
    for (int t = 0; t < int(triangles_.size()); ++t)
      if (angle(t) < target) inserted += split(t, target);
    if (inserted == before) break;
  }
  return inserted;
}

bool Triangulation::move_for_the_better(int vertex) {
  const std::vector<int> star = star_of(vertex);
  const auto angle_at = [&](const Vec2& place) {
    double smallest = 10;
    for (const int t : star) {
      const auto& v = triangles_[t].vertices;
      const auto at = [&](int k) -> const Vec2& { return v[k] == vertex ? place : points_[v[k]]; };
      smallest = std::min(smallest, smallest_angle(at(0), at(1), at(2)));
    }
    return smallest;
  };
  const double before = angle_at(points_[vertex]);
  double nearest = INFINITY, reached = before;
  for (const int t : star)
    for (const int v : triangles_[t].vertices)
      if (v != vertex) nearest = std::min(nearest, (points_[v] - points_[vertex]).norm());
  Vec2 place = points_[vertex];
  for (double step = nearest / 2; step > nearest / 50; step /= 2)
    for (const Vec2& way : {Vec2(1, 0), Vec2(0, 1), Vec2(-1, 0), Vec2(0, -1), Vec2(.7, .7), Vec2(-.7, .7),
                            Vec2(-.7, -.7), Vec2(.7, -.7)}) {
      const Vec2 point = place + step * way;
      if (const double angle = angle_at(point); angle > reached) reached = angle, place = point;
    }
  if (reached < before + least_gain) return false;
  points_[vertex] = place;
  std::vector<std::pair<int, int>> suspects;
  for (const int t : star)
    for (int k = 0; k < 3; ++k) suspects.emplace_back(t, k);
  settle(suspects);
  return true;
}

int Triangulation::smooth(double target) {
  std::vector<int> sharp;
  for (int t = 0; t < int(triangles_.size()); ++t)
    if (angle(t) < target)
      for (const int v : triangles_[t].vertices)
        if (v >= given_) sharp.push_back(v);
  std::ranges::sort(sharp);
  sharp.erase(std::unique(sharp.begin(), sharp.end()), sharp.end());
  int moved = 0;
  for (const int v : sharp) moved += move_for_the_better(v);
  return moved;
}

void Triangulation::refine(double target) {
  for (int round = 0; round < most_rounds; ++round) {
    const int inserted = insert_where_sharp(target), moved = smooth(target);
    if (inserted + moved == 0) break;
  }
}

} // namespace taut::garment
