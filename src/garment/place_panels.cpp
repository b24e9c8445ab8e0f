#include "src/garment/place_panels.hpp"

#include "src/garment/polygon.hpp"

#include <Eigen/QR>

#include <algorithm>
#include <cmath>

namespace taut::garment {

namespace {

constexpr int pieces = 16; ///< that an edge is cut into to see where it is

std::vector<Vec2> points_of(const Curve& curve) {
  std::vector<double> parts;
  for (int i = 0; i <= pieces; ++i) parts.push_back(double(i) / pieces);
  return points_along(curve, parts);
}

Vec3 place_of(const Panel& panel, const Vec2& p) {
  return panel.rotation * Vec3(p[0], p[1], 0) + panel.translation;
}

std::vector<Vec3> outline_of(const Panel& panel) {
  std::vector<Vec3> outline;
  for (const PatternEdge& edge : panel.edges) {
    const auto points = points_of(edge.curve);
    for (int i = 0; i < pieces; ++i) outline.push_back(place_of(panel, points[i]));
  }
  return outline;
}

/// From where to where along y, m.
std::array<double, 2> heights_of(const Panel& panel) {
  const auto outline = outline_of(panel);
  const auto [low, high] = std::minmax_element(outline.begin(), outline.end(),
                                               [](const Vec3& a, const Vec3& b) { return a[1] < b[1]; });
  return {(*low)[1], (*high)[1]};
}

bool is_above(const std::array<double, 2>& one, const std::array<double, 2>& two) { return one[0] >= two[1]; }

/// How far the first edge of a seam is above the second, m: the mean along the seam.
double height_over(const SewingPattern& pattern, const Seam& seam) {
  double sum = 0;
  for (const SeamSide& side : seam.sides) {
    const Panel& panel = pattern.panels[side.panel];
    for (const Vec2& p : points_of(panel.edges[side.edge].curve))
      sum += (side == seam.sides[0] ? 1 : -1) * place_of(panel, p)[1];
  }
  return sum / (pieces + 1);
}

void close_up(SewingPattern& pattern) {
  const auto n = Eigen::Index(pattern.panels.size());
  Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd gaps = Eigen::VectorXd::Zero(n);
  std::vector<std::array<double, 2>> heights;
  for (const Panel& panel : pattern.panels) heights.push_back(heights_of(panel));
  for (const Seam& seam : pattern.seams) {
    const auto a = seam.sides[0].panel, b = seam.sides[1].panel;
    if (a == b) continue;
    const double length = length_of(pattern.panels[a].edges[seam.sides[0].edge].curve);
    sums(a, a) += length;
    sums(b, b) += length;
    sums(a, b) -= length;
    sums(b, a) -= length;
    const bool are_above_each_other = is_above(heights[a], heights[b]) || is_above(heights[b], heights[a]);
    const double gap = are_above_each_other ? length * height_over(pattern, seam) : 0;
    gaps[a] -= gap;
    gaps[b] += gap;
  }
  const Eigen::VectorXd shifts = sums.completeOrthogonalDecomposition().solve(gaps);
  for (Eigen::Index p = 0; p < n; ++p) pattern.panels[p].translation[1] += shifts[p];
}

bool is_between(const Seam& seam, int one, int two) {
  const int a = seam.sides[0].panel, b = seam.sides[1].panel;
  return (a == one && b == two) || (a == two && b == one);
}

bool are_sewn(const SewingPattern& pattern, int one, int two) {
  return std::any_of(pattern.seams.begin(), pattern.seams.end(),
                     [&](const Seam& seam) { return is_between(seam, one, two); });
}

std::vector<Vec3> places_along(const SewingPattern& pattern, const SeamSide& side) {
  const Panel& panel = pattern.panels[side.panel];
  std::vector<Vec3> places;
  for (const Vec2& p : points_of(panel.edges[side.edge].curve)) places.push_back(place_of(panel, p));
  return places;
}

/// Points of seams between two panels, of which both sides are at one place, to within `near` (m).
std::vector<Vec3> closed_places(const SewingPattern& pattern, int one, int two, double near) {
  std::vector<Vec3> closed;
  for (const Seam& seam : pattern.seams) {
    if (!is_between(seam, one, two)) continue;
    const auto first = places_along(pattern, seam.sides[0]);
    auto second = places_along(pattern, seam.sides[1]);
    if (seam.direction == SeamDirection::start_to_end) std::reverse(second.begin(), second.end());
    for (int i = 0; i <= pieces; ++i)
      if ((first[i] - second[i]).norm() < near) closed.push_back(first[i]);
  }
  return closed;
}

/// In the plane of a panel, and from it.
Vec3 seen_from(const Panel& panel, const Vec3& x) {
  return panel.rotation.transpose() * (x - panel.translation);
}

Ring ring_of(const Panel& panel, std::span<const Vec3> outline) {
  Ring ring;
  for (const Vec3& x : outline) ring.push_back(seen_from(panel, x).head<2>());
  return ring;
}

constexpr double touching = 0.1; ///< of `apart`: what curves that are cut into pieces have in common

/// Whether the outline of one panel touches another elsewhere than where it is closed. That counts as an
/// intersection, even where a seam goes along, when it is gathered: what belongs together is not at one
/// place.
bool touches_unclosed(const SewingPattern& pattern, int p, int q, double apart) {
  const double near = touching * apart;
  const Panel &one = pattern.panels[p], &two = pattern.panels[q];
  const Ring ring = ring_of(two, outline_of(two));
  const auto closed = closed_places(pattern, p, q, near);
  const auto outline = outline_of(one);
  return std::any_of(outline.begin(), outline.end(), [&](const Vec3& x) {
    const auto is_beside = [&](const Vec3& c) { return (x - c).norm() < 0.5 * apart; }; // a corner
    if (std::any_of(closed.begin(), closed.end(), is_beside)) return false;
    const Vec3 seen = seen_from(two, x);
    if (std::abs(seen[2]) >= near) return false;
    return std::hypot(seen[2], distance_between(ring, Vec2(seen.head<2>()))) < near;
  });
}

/// Whether they are parallel and in each other's way: nearer than `apart`, or, if they are sewn together,
/// one on the other.
bool lie_on_each_other(const SewingPattern& pattern, int p, int q, double apart) {
  constexpr double parallel = 0.999; // cosine
  const Panel &one = pattern.panels[p], &two = pattern.panels[q];
  if (std::abs(one.rotation.col(2).dot(two.rotation.col(2))) < parallel) return false;
  const auto outline = outline_of(two);
  double nearest = HUGE_VAL; // m, from the plane of the one
  for (const Vec3& x : outline) nearest = std::min(nearest, std::abs(seen_from(one, x)[2]));
  constexpr double almost = 0.99; // where it was moved to
  if (nearest >= almost * apart) return false;
  const Ring rings[] = {ring_of(one, outline_of(one)), ring_of(one, outline)};
  return are_sewn(pattern, p, q) ? common_area(rings[0], rings[1]) > std::pow(touching * apart, 2)
                                 : distance_between(rings[0], rings[1]) < apart;
}

bool are_in_the_way(const SewingPattern& pattern, int p, int q, double apart) {
  if (are_sewn(pattern, p, q) &&
      (touches_unclosed(pattern, p, q, apart) || touches_unclosed(pattern, q, p, apart)))
    return true;
  return lie_on_each_other(pattern, p, q, apart);
}

Vec3 middle_of(std::span<const Panel> panels) {
  Vec3 sum = Vec3::Zero();
  std::size_t count = 0;
  for (const Panel& panel : panels)
    for (const Vec3& x : outline_of(panel)) {
      sum += x;
      ++count;
    }
  return sum / double(std::max<std::size_t>(count, 1));
}

void move_apart(SewingPattern& pattern, double apart) {
  const Vec3 middle = middle_of(pattern.panels);
  for (int p = 1; p < int(pattern.panels.size()); ++p) {
    Panel& panel = pattern.panels[p];
    const Vec3 normal = panel.rotation.col(2);
    const double side = normal.dot(middle_of(std::span(&panel, 1)) - middle) < 0 ? -1 : 1;
    const auto is_blocked = [&] {
      for (int q = 0; q < p; ++q)
        if (are_in_the_way(pattern, q, p, apart)) return true;
      return false;
    };
    while (is_blocked()) panel.translation += side * apart * normal;
  }
}

} // namespace

SewingPattern place_panels(SewingPattern pattern, double apart) {
  close_up(pattern);
  move_apart(pattern, apart);
  return pattern;
}

} // namespace taut::garment
