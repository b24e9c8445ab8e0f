#include "io/whole_file.hpp"
#include "partition/comm.hpp"
#include "src/garment/polygon.hpp"
#include "src/garment/read_pattern.hpp"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fstream>
#include <sstream>

namespace taut::garment {

namespace {

constexpr double largest = 25; ///< m: wider than the cloth of any garment

/// An outline as a polygon that follows its curves closely.
struct FineOutline {
  Ring points;
  std::vector<int> edges; ///< to which the side from each point to the next belongs
};

FineOutline fine_outline(const Panel& panel) {
  constexpr int sides = 100; // of a curved edge
  std::vector<double> parts;
  for (int i = 0; i <= sides; ++i) parts.push_back(double(i) / sides);
  FineOutline outline;
  for (std::size_t e = 0; e < panel.edges.size(); ++e) {
    const Curve& curve = panel.edges[e].curve;
    const double chord = (end_of(curve) - start_of(curve)).norm();
    auto points = length_of(curve) < chord * (1 + 1e-12) ? Ring{start_of(curve)} : points_along(curve, parts);
    if (points.size() > 1) points.pop_back();
    outline.points.insert(outline.points.end(), points.begin(), points.end());
    outline.edges.resize(outline.points.size(), int(e));
  }
  return outline;
}

double distance(const Vec2& p, const Vec2& a, const Vec2& b) {
  const double along = std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
  return (a + along * (b - a) - p).norm();
}

/// "edges 2 and 5": those nearest to a point; one alone, where it meets itself.
std::string edges_at(const FineOutline& outline, const Vec2& place) {
  std::vector<double> near;
  for (std::size_t i = 0; i < outline.points.size(); ++i) {
    const std::size_t e = std::size_t(outline.edges[i]);
    if (e >= near.size()) near.resize(e + 1, HUGE_VAL);
    near[e] = std::min(near[e],
                       distance(place, outline.points[i], outline.points[(i + 1) % outline.points.size()]));
  }
  const double touching = 1e-6 * largest;
  std::vector<std::size_t> there;
  for (std::size_t e = 0; e < near.size(); ++e)
    if (near[e] < touching) there.push_back(e);
  if (there.size() == 1) return fmt::format("edge {} meets itself", there[0]);
  if (there.empty()) return "its edges meet";
  return fmt::format("edges {} and {} meet", there.front(), there.back());
}

bool on_one_line(const Ring& points) {
  Vec2 mean = Vec2::Zero();
  for (const Vec2& p : points) mean += p / double(points.size());
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  for (const Vec2& p : points) spread += (p - mean) * (p - mean).transpose();
  return !(spread.determinant() > 1e-12 * spread.trace() * spread.trace());
}

void check_panel(const Panel& panel) {
  const FineOutline outline = fine_outline(panel);
  Vec2 low = outline.points[0], high = low;
  for (const Vec2& p : outline.points) low = low.cwiseMin(p), high = high.cwiseMax(p);
  const Vec2 size = high - low;
  const auto fail = [&](const std::string& what) {
    throw InputError(fmt::format("{}: panel '{}' {}", panel.place, panel.name, what));
  };
  if (!size.allFinite() || size.maxCoeff() > largest)
    fail(
        fmt::format("is {:.3g} m by {:.3g} m large; if the numbers of the pattern are centimetres, say so by "
                    "properties: {{units_in_meter: 100}}",
                    size[0], size[1]));
  constexpr double farthest = 1000;
  if (!(panel.translation.norm() < farthest))
    fail(fmt::format("is placed {:.3g} m away; correct its translation, or units_in_meter",
                     panel.translation.norm()));
  if (on_one_line(outline.points)) fail("has no area: its edges lie on one line; correct its vertices");
  if (const auto fault = fault_of_ring(outline.points))
    fail(fmt::format(
        "crosses or touches itself: {} at ({:.4f}, {:.4f}) m in its plane; move their vertices, or lessen "
        "their curvature",
        edges_at(outline, fault->place), fault->place[0], fault->place[1]));
}

std::string text_of(const std::filesystem::path& file) {
  std::error_code error;
  std::ifstream in(file);
  if (!std::filesystem::is_regular_file(file, error) || !in)
    throw InputError(fmt::format("{}: no such file, or it may not be read; check its name", file.string()));
  std::ostringstream all;
  all << in.rdbuf();
  return all.str();
}

} // namespace

void check_panels(const SewingPattern& pattern) {
  for (const Panel& panel : pattern.panels) check_panel(panel);
}

SewingPattern read_pattern(MPI_Comm comm, const std::filesystem::path& file) {
  const std::string text = broadcast(comm, [&] { return text_of(file); });
  SewingPattern pattern = parse_pattern(text, file.string());
  check_panels(pattern);
  return pattern;
}

} // namespace taut::garment
