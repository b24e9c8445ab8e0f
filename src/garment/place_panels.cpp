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

bool are_sewn(const SewingPattern& pattern, int one, int two) {
  return std::any_of(pattern.seams.begin(), pattern.seams.end(), [&](const Seam& seam) {
    const int a = seam.sides[0].panel, b = seam.sides[1].panel;
    return (a == one && b == two) || (a == two && b == one);
  });
}

/// Whether they are parallel and in each other's way: nearer than `apart`, or, if they are sewn together and
/// so may touch, one on the other.
bool are_in_the_way(const SewingPattern& pattern, int p, int q, double apart) {
  constexpr double parallel = 0.999; // cosine
  constexpr double touching = 0.1; // of `apart`, squared: what curves that are cut into pieces have in common
  const Panel &one = pattern.panels[p], &two = pattern.panels[q];
  if (std::abs(one.rotation.col(2).dot(two.rotation.col(2))) < parallel) return false;
  std::array<Ring, 2> rings;
  double nearest = HUGE_VAL; // m, from the plane of the one
  for (const Vec3& x : outline_of(two)) {
    const Vec3 in_plane = one.rotation.transpose() * (x - one.translation);
    rings[1].push_back(in_plane.head<2>());
    nearest = std::min(nearest, std::abs(in_plane[2]));
  }
  constexpr double almost = 0.99; // where it was moved to
  if (nearest >= almost * apart) return false;
  for (const Vec3& x : outline_of(one))
    rings[0].push_back((one.rotation.transpose() * (x - one.translation)).head<2>());
  return are_sewn(pattern, p, q) ? common_area(rings[0], rings[1]) > std::pow(touching * apart, 2)
                                 : distance_between(rings[0], rings[1]) < apart;
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
