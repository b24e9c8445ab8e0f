#include "src/garment/sharpness.hpp"

#include "src/garment/triangulation.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace taut::garment {

namespace {

/// A sharp corner with what is thin of it.
struct Tip {
  Vec2 corner;
  double reach; ///< m
};

std::vector<Tip> find_tips(std::span<const Vec2> outline, std::span<const int> corners, double spacing) {
  constexpr double sharp = std::numbers::pi / 6;
  std::vector<Tip> tips;
  for (const int corner : corners) {
    const std::size_t c = std::size_t(corner) % outline.size();
    const Vec2 &at = outline[c], on = outline[(c + 1) % outline.size()] - at,
               back = outline[(c + outline.size() - 1) % outline.size()] - at;
    const double angle = std::atan2(on[0] * back[1] - on[1] * back[0], on.dot(back));
    if (angle > 0 && angle < sharp) tips.push_back({at, spacing * std::max(3.0, 0.5 / std::tan(angle / 2))});
  }
  return tips;
}

} // namespace

Sharpness sharpness_of(const PanelMesh& mesh, std::size_t outline_points, std::span<const int> corners,
                       double spacing) {
  const auto tips = find_tips({mesh.points.data(), outline_points}, corners, spacing);
  Sharpness found;
  for (const auto& cell : mesh.cells) {
    if (cell[3] >= 0) continue;
    const Vec2 &a = mesh.points[cell[0]], &b = mesh.points[cell[1]], &c = mesh.points[cell[2]];
    const SharpPlace here{smallest_angle(a, b, c), (a + b + c) / 3};
    if (here.angle < found.all.angle) found.all = here;
    const auto in_tip = [&](const Tip& tip) { return (here.place - tip.corner).norm() < tip.reach; };
    if (here.angle < found.elsewhere.angle && std::ranges::none_of(tips, in_tip)) found.elsewhere = here;
  }
  return found;
}

} // namespace taut::garment
