#include "src/linear/spline_grid.hpp"

#include <algorithm>

namespace taut {

void SplineGrid::set(const SparseRows& rows, std::span<const double> values, std::span<const char> held) {
  held_ = held;
  std::fill(values_.begin(), values_.end(), 0.0);
  for (Local cell = 0; cell < cells_.size(); ++cell)
    if (!points_in(cell).empty()) add_cell(rows, values, cell);
  to_owners_.forward_add<double>(values_, values_);
}

/// Adds what the rows of a cell's owned points give: first to a dense block between the nodes of the cell and
/// all in its reach.
void SplineGrid::add_cell(const SparseRows& rows, std::span<const double> values, Local cell) {
  const auto near_cells = near(cell), reached = reach(cell);
  const std::uint8_t* places = near_places_.data() + std::size_t(near_offsets_[cell]) * per_cell_;
  SplineCells::Weights w;
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
      cells_.weigh(j, w);
      for (std::size_t b = 0; b < per_cell_; ++b) row_[at[b]] += s * w[b];
    }
    cells_.weigh(i, w);
    double* block = block_.data();
    for (std::size_t a = 0; a < per_cell_; ++a)
      for (const double r : row_) *block++ += w[a] * r;
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
  SplineCells::Weights w;
  for (Local cell = 0; cell < cells_.size(); ++cell) {
    const auto nodes = nodes_of(cell);
    for (const Local i : points_in(cell)) {
      if (is_held(i)) continue;
      cells_.weigh(i, w);
      for (std::size_t a = 0; a < per_cell_; ++a) coarse[nodes[a]] += w[a] * fine[i];
    }
  }
  halo_.accumulate(coarse);
}

void SplineGrid::add_spread(std::vector<Vec3>& coarse, std::span<Vec3> fine) const {
  halo_.update(coarse);
  SplineCells::Weights w;
  for (Local cell = 0; cell < cells_.size(); ++cell) {
    const auto nodes = nodes_of(cell);
    for (const Local i : points_in(cell)) {
      if (is_held(i)) continue;
      cells_.weigh(i, w);
      Vec3 sum = Vec3::Zero();
      for (std::size_t a = 0; a < per_cell_; ++a) sum += w[a] * coarse[nodes[a]];
      fine[i] += sum;
    }
  }
}

} // namespace taut
