#include "src/linear/spline_basis.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_map>

namespace taut {

namespace {

constexpr int bits = 20; // of a key, for each axis; nodes further apart may share one, which does no harm
constexpr Global mask = (Global(1) << bits) - 1;

Global key_of(Global i, Global j, Global k) {
  return (i & mask) << (2 * bits) | (j & mask) << bits | (k & mask);
}

} // namespace

SplineBasis::SplineBasis(MPI_Comm comm, std::span<const Vec3> points, double spacing)
    : spacing_(spacing), places_(points.size()) {
  std::array<double, 6> box; // -min, max
  box.fill(-HUGE_VAL);
  for (const Vec3& p : points)
    for (int d = 0; d < 3; ++d) {
      box[d] = std::max(box[d], -p[d]);
      box[3 + d] = std::max(box[3 + d], p[d]);
    }
  max_in_place(comm, box);
  for (int d = 0; d < 3; ++d) origin_[d] = -box[d];
  const auto is_wide = [&](int d) { return box[3 + d] + box[d] >= 0.5 * spacing; };
  axes_ = {0, 1, 2};
  dimension_ = int(std::stable_partition(axes_.begin(), axes_.end(), is_wide) - axes_.begin());

  std::unordered_map<Global, Local> cells;
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::array<Global, 3> first{0, 0, 0};
    for (int d = 0; d < dimension_; ++d) {
      const double s = (points[i][axes_[d]] - origin_[axes_[d]]) / spacing, whole = std::floor(s);
      first[d] = Global(whole);
      places_[i].at[d] = float(s - whole);
    }
    const auto [cell, is_new] = cells.try_emplace(key_of(first[0], first[1], first[2]), size());
    if (is_new) first_.push_back(first);
    places_[i].cell = cell->second;
  }
}

std::vector<Global> SplineBasis::node_keys(Local cell) const {
  const auto& [i, j, k] = first_[cell];
  std::vector<Global> keys;
  for (int a = 0; a < count(0); ++a)
    for (int b = 0; b < count(1); ++b)
      for (int c = 0; c < count(2); ++c) keys.push_back(key_of(i + a, j + b, k + c));
  return keys;
}

Vec3 SplineBasis::node_point(Global key) const {
  Vec3 point = origin_;
  for (int d = 0; d < dimension_; ++d)
    point[axes_[d]] += (double(key >> ((2 - d) * bits) & mask) - 0.5) * spacing_;
  return point;
}

} // namespace taut
