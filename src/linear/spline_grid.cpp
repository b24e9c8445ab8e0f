#include "src/linear/spline_grid.hpp"

#include <algorithm>

namespace taut {

namespace {

/// work(dimension), which is of the cells, as a constant.
template<class Work>
void in_dimension_of(const SplineBasis& cells, Work&& work) {
  switch (cells.dimension()) {
  case 0:
    return work(std::integral_constant<int, 0>());
  case 1:
    return work(std::integral_constant<int, 1>());
  case 2:
    return work(std::integral_constant<int, 2>());
  default:
    return work(std::integral_constant<int, 3>());
  }
}

} // namespace

void SplineGrid::set(const SparseRows& rows, std::span<const double> values, std::span<const char> held) {
  held_ = held;
  std::fill(values_.begin(), values_.end(), 0.0);
  in_dimension_of(cells_, [&](auto dimension) {
    for (Local cell = 0; cell < cells_.size(); ++cell)
      if (!points_in(cell).empty()) add_cell<dimension>(rows, values, cell);
  });
  to_owners_.forward_add<double>(values_, values_);
}

/// Adds what the rows of a cell's owned points give: first to a dense block between the nodes of the cell and
/// all in its reach.
template<int dimension>
void SplineGrid::add_cell(const SparseRows& rows, std::span<const double> values, Local cell) {
  const auto near_cells = near(cell), reached = reach(cell);
  const std::uint8_t* places = near_places_.data() + std::size_t(near_offsets_[cell]) * per_cell_;
  block_.assign(per_cell_ * reached.size(), 0.0);
  row_.resize(reached.size());
  for (const Local i : points_in(cell)) {
    if (is_held(i)) continue;
    std::fill(row_.begin(), row_.end(), 0.0);
    const double* value = values.data() + rows.offsets[i];
    for (const Local j : rows.columns(i)) {
      const double s = *value++;
      if (s == 0 || is_held(j)) continue;
      std::size_t k = 0;
      while (near_cells[k] != cells_.cell_of(j)) ++k;
      const std::uint8_t* at = places + k * per_cell_;
      for (const double w : cells_.weights<dimension>(j)) row_[*at++] += s * w;
    }
    double* block = block_.data();
    for (const double w : cells_.weights<dimension>(i))
      for (const double r : row_) *block++ += w * r;
  }
  const double* block = block_.data();
  for (const Local node : nodes_of(cell)) {
    std::int64_t slot = offsets_[node];
    for (const Local column : reached) {
      while (columns_[slot] != column) ++slot;
      values_[slot] += *block++;
    }
  }
}

void SplineGrid::gather(std::span<const Vec3> fine, std::vector<Vec3>& coarse) const {
  std::fill(coarse.begin(), coarse.end(), Vec3::Zero());
  in_dimension_of(cells_, [&](auto dimension) {
    for (Local cell = 0; cell < cells_.size(); ++cell) {
      std::array<Vec3, SplineBasis::nodes_of_cell(dimension)> sums;
      sums.fill(Vec3::Zero());
      for (const Local i : points_in(cell)) {
        if (is_held(i)) continue;
        const auto w = cells_.weights<dimension>(i);
        for (std::size_t a = 0; a < w.size(); ++a) sums[a] += w[a] * fine[i];
      }
      const auto nodes = nodes_of(cell);
      for (std::size_t a = 0; a < sums.size(); ++a) coarse[nodes[a]] += sums[a];
    }
  });
  halo_.accumulate(coarse);
}

void SplineGrid::add_spread(std::vector<Vec3>& coarse, std::span<Vec3> fine) const {
  halo_.update(coarse);
  in_dimension_of(cells_, [&](auto dimension) {
    for (Local cell = 0; cell < cells_.size(); ++cell) {
      std::array<Vec3, SplineBasis::nodes_of_cell(dimension)> values;
      const auto nodes = nodes_of(cell);
      for (std::size_t a = 0; a < values.size(); ++a) values[a] = coarse[nodes[a]];
      for (const Local i : points_in(cell)) {
        if (is_held(i)) continue;
        const auto w = cells_.weights<dimension>(i);
        Vec3 sum = Vec3::Zero();
        for (std::size_t a = 0; a < w.size(); ++a) sum += w[a] * values[a];
        fine[i] += sum;
      }
    }
  });
}

} // namespace taut
