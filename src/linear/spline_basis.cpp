#include "src/linear/spline_basis.hpp"

#include "src/linear/bounding_box.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_map>

namespace taut {

namespace {

constexpr int bits = 20; // of a key, for each axis; nodes further apart may share one, which does no harm
constexpr Global mask = (Global(1) << bits) - 1;
constexpr double on_a_node = 1e-10; // of a cell

Global key_of(Global i, Global j, Global k) {
  return (i & mask) << (2 * bits) | (j & mask) << bits | (k & mask);
}

} // namespace

template<int degree>
SplineBasis<degree>::SplineBasis(MPI_Comm comm, std::span<const Vec3> points, double spacing)
    : spacing_(spacing), places_(points.size()) {
  const BoundingBox box = bounding_box(comm, points);
  origin_ = box.lowest;
  const Vec3 width = box.highest - box.lowest;
  const auto is_wide = [&](int d) { return width[d] >= 0.5 * spacing; };
  axes_ = {0, 1, 2};
  dimension_ = int(std::stable_partition(axes_.begin(), axes_.end(), is_wide) - axes_.begin());
  for (int d = 0; d < dimension_; ++d)
    last_[d] = std::max<Global>(Global(std::ceil(width[axes_[d]] / spacing - on_a_node)) - 1, 0);

  std::unordered_map<Global, Local> cells;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto [first, at] = corner_of(points[i]);
    const auto [cell, is_new] = cells.try_emplace(key_of(first[0], first[1], first[2]), size());
    if (is_new) first_.push_back(first);
    places_[i] = {cell->second, at};
  }
}

/// Linear splines are told apart by whether a point is on their nodes: one that is but for round-off counts
/// as being there, and at the upper end it belongs to the last cell; otherwise there would be nodes that next
/// to nothing, or nothing, depends on.
template<int degree>
typename SplineBasis<degree>::Corner SplineBasis<degree>::corner_of(const Vec3& point) const {
  Corner corner{{0, 0, 0}, {0, 0, 0}};
  for (int d = 0; d < dimension_; ++d) {
    double s = (point[axes_[d]] - origin_[axes_[d]]) / spacing_, whole = std::floor(s);
    if constexpr (degree == 1) {
      const double nearest = std::round(s);
      if (std::abs(s - nearest) < on_a_node) s = nearest;
      whole = std::min(std::floor(s), double(last_[d]));
    }
    corner.first[d] = Global(whole);
    corner.at[d] = typename Within::value_type(s - whole);
  }
  return corner;
}

template<int degree>
std::vector<Global> SplineBasis<degree>::node_keys(Local cell) const {
  return keys_from(first_[cell]);
}

template<int degree>
std::vector<Global> SplineBasis<degree>::keys_from(const std::array<Global, 3>& first) const {
  const auto& [i, j, k] = first;
  std::vector<Global> keys;
  for (int a = 0; a < count(0); ++a)
    for (int b = 0; b < count(1); ++b)
      for (int c = 0; c < count(2); ++c) keys.push_back(key_of(i + a, j + b, k + c));
  return keys;
}

template<int degree>
Vec3 SplineBasis<degree>::node_point(Global key) const {
  constexpr double centre = 0.5 * (degree + 1) - degree; // of the spline, after the corner its key names
  Vec3 point = origin_;
  for (int d = 0; d < dimension_; ++d)
    point[axes_[d]] += (double(key >> ((2 - d) * bits) & mask) + centre) * spacing_;
  return point;
}

template class SplineBasis<1>;
template class SplineBasis<2>;

} // namespace taut
