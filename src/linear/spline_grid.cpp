#include "src/linear/spline_grid.hpp"

#include <algorithm>

namespace taut {

namespace {

template<class Entry>
Entry zero() {
  if constexpr (std::same_as<Entry, double>)
    return 0.0;
  else
    return Entry::Zero();
}

/// sum += value, which may stand for a multiple of the identity.
void add_to(double& sum, double value) { sum += value; }
void add_to(Mat3& sum, double value) { sum.diagonal().array() += value; }
void add_to(Mat3& sum, const Mat3& value) { sum += value; }

bool is_zero(double value) { return value == 0; }
bool is_zero(const Mat3&) { return false; } // not worth a look

} // namespace

template<int degree, class Value>
SplineGrid<degree, Value>::SplineGrid(MPI_Comm comm, const SparseRows& rows, std::span<const Vec3> points,
                                      double spacing)
    : Nodes(comm, rows, points, spacing), values_(columns_.size(), zero<Value>()) {
  if constexpr (has_blocks) find_slots();
}

template<int degree, class Value>
void SplineGrid<degree, Value>::start(std::span<const char> held) {
  held_ = held;
  freedom_ = nullptr;
  std::fill(values_.begin(), values_.end(), zero<Value>());
}

template<int degree, class Value>
template<class Entry>
void SplineGrid<degree, Value>::add(const SparseRows& rows, std::span<const Entry> values) {
  cells_.in_dimension([&](auto dimension) {
    for (Local cell = 0; cell < cells_.size(); ++cell)
      if (!points_in(cell).empty()) add_cell<dimension>(rows, values, cell);
  });
  if constexpr (has_blocks)
    if (freedom_ && freedom_->has_sliding())
      cells_.in_dimension([&](auto dimension) { add_sliding<dimension>(rows, values); });
}

template<int degree, class Value>
void SplineGrid<degree, Value>::finish() {
  to_owners_.template forward_add<Value>(values_, values_);
}

/// Adds what the rows of a cell's owned points give: first to a dense block between the nodes of the cell and
/// all in its reach.
template<int degree, class Value>
template<int dimension, class Entry>
void SplineGrid<degree, Value>::add_cell(const SparseRows& rows, std::span<const Entry> values, Local cell) {
  const auto near_cells = near(cell), reached = reach(cell);
  const Local* places = places_near(cell);
  auto& [room, row] = std::get<Room<Entry>>(room_);
  room.assign(per_cell_ * reached.size(), zero<Entry>());
  row.resize(reached.size());
  for (const Local i : points_in(cell)) {
    if (is_out(i)) continue;
    std::fill(row.begin(), row.end(), zero<Entry>());
    const Entry* value = values.data() + rows.offsets[i];
    for (const Local j : rows.columns(i)) {
      const Entry& s = *value++;
      if (is_zero(s) || is_out(j)) continue;
      std::size_t k = 0;
      while (near_cells[k] != cells_.cell_of(j)) ++k;
      const Local* at = places + k * per_cell_;
      for (const double w : cells_.template weights<dimension>(j)) row[*at++] += s * w;
    }
    Entry* block = room.data();
    for (const double w : cells_.template weights<dimension>(i))
      for (const Entry& r : row) *block++ += w * r;
  }
  const Entry* block = room.data();
  for (const Local node : nodes_of(cell)) {
    std::int64_t slot = offsets_[node];
    for (const Local column : reached) {
      while (columns_[slot] != column) ++slot;
      add_to(values_[slot], *block++);
    }
  }
}

/// What points that may move in some directions are part of: as rows, as columns, or both.
template<int degree, class Value>
template<int dimension, class Entry>
void SplineGrid<degree, Value>::add_sliding(const SparseRows& rows, std::span<const Entry> values) {
  for (Local i = 0; i < rows.size(); ++i) {
    const Entry* value = values.data() + rows.offsets[i];
    for (const Local j : rows.columns(i)) {
      const Entry& entry = *value++;
      if ((freedom_->is_free(i) && freedom_->is_free(j)) || freedom_->is_held(i) || freedom_->is_held(j))
        continue;
      add_block<dimension>(i, j, Mat3(freedom_->projector(i) * entry * freedom_->projector(j)));
    }
  }
}

template<int degree, class Value>
template<int dimension>
void SplineGrid<degree, Value>::add_block(Local row_point, Local column_point, const Mat3& block) {
  const auto columns = cells_.template weights<dimension>(column_point);
  const std::int32_t* slot = slots_between(cells_.cell_of(row_point), cells_.cell_of(column_point));
  for (const double w : cells_.template weights<dimension>(row_point))
    for (const double c : columns) values_[*slot++] += w * c * block;
}

template<int degree, class Value>
template<std::size_t n>
void SplineGrid<degree, Value>::add_rank_one(const std::array<Local, n>& vertices,
                                             const std::array<Vec3, n>& gradient) requires has_blocks {
  cells_.in_dimension([&](auto dimension) { add_gradient<dimension>(vertices, gradient); });
}

/// Vertices of one cell are taken together: mostly there are one or two cells.
template<int degree, class Value>
template<int dimension, std::size_t n>
void SplineGrid<degree, Value>::add_gradient(const std::array<Local, n>& vertices,
                                             const std::array<Vec3, n>& gradient) {
  std::array<CellPart<dimension>, n> parts;
  std::size_t count = 0;
  for (std::size_t v = 0; v < n; ++v) {
    const Local cell = cells_.cell_of(vertices[v]);
    std::size_t p = 0;
    while (p < count && parts[p].cell != cell) ++p;
    auto& part = parts[p];
    if (p == count) {
      ++count;
      part.cell = cell;
      part.has_own = false;
      part.all.fill(Vec3::Zero());
      part.own.fill(Vec3::Zero());
    }
    const Vec3 g = freedom_ ? freedom_->allowed(vertices[v], gradient[v]) : gradient[v];
    const auto w = cells_.template weights<dimension>(vertices[v]);
    for (std::size_t a = 0; a < w.size(); ++a) part.all[a] += w[a] * g;
    if (vertices[v] >= own_points()) continue;
    part.has_own = true;
    for (std::size_t a = 0; a < w.size(); ++a) part.own[a] += w[a] * g;
  }
  for (std::size_t p = 0; p < count; ++p)
    for (std::size_t q = 0; parts[p].has_own && q < count; ++q) {
      const std::int32_t* slot = slots_between(parts[p].cell, parts[q].cell);
      for (const Vec3& row : parts[p].own)
        for (const Vec3& column : parts[q].all) values_[*slot++].noalias() += row * column.transpose();
    }
}

/// Of all pairs of nodes of two cells.
template<int degree, class Value>
const std::int32_t* SplineGrid<degree, Value>::slots_between(Local cell, Local other) const {
  const auto near_cells = near(cell);
  std::size_t k = 0;
  while (near_cells[k] != other) ++k;
  return near_slots_.data() + (std::size_t(near_offsets_[cell]) + k) * per_cell_ * per_cell_;
}

template<int degree, class Value>
void SplineGrid<degree, Value>::find_slots() {
  for (Local cell = 0; cell < cells_.size(); ++cell)
    for (const Local other : near(cell))
      for (const Local row : nodes_of(cell))
        for (const Local column : nodes_of(other)) {
          const auto begin = columns_.begin() + offsets_[row], end = columns_.begin() + offsets_[row + 1];
          near_slots_.push_back(std::int32_t(std::lower_bound(begin, end, column) - columns_.begin()));
        }
}

template<int degree, class Value>
void SplineGrid<degree, Value>::gather(std::span<const Vec3> fine, std::vector<Vec3>& coarse) const {
  std::fill(coarse.begin(), coarse.end(), Vec3::Zero());
  cells_.in_dimension([&](auto dimension) {
    for (Local cell = 0; cell < cells_.size(); ++cell) {
      std::array<Vec3, SplineBasis<degree>::nodes_of_cell(dimension)> sums;
      sums.fill(Vec3::Zero());
      const auto add_point = [&](Local i, const Vec3& value) {
        const auto w = cells_.template weights<dimension>(i);
        for (std::size_t a = 0; a < w.size(); ++a) sums[a] += w[a] * value;
      };
      for (const Local i : points_in(cell))
        if (!is_out(i))
          add_point(i, fine[i]);
        else if (freedom_)
          add_point(i, freedom_->allowed(i, fine[i]));
      const auto nodes = nodes_of(cell);
      for (std::size_t a = 0; a < sums.size(); ++a) coarse[nodes[a]] += sums[a];
    }
  });
  halo_.accumulate(coarse);
}

template<int degree, class Value>
void SplineGrid<degree, Value>::add_spread(std::vector<Vec3>& coarse, std::span<Vec3> fine) const {
  halo_.update(coarse);
  cells_.in_dimension([&](auto dimension) {
    for (Local cell = 0; cell < cells_.size(); ++cell) {
      std::array<Vec3, SplineBasis<degree>::nodes_of_cell(dimension)> values;
      const auto nodes = nodes_of(cell);
      for (std::size_t a = 0; a < values.size(); ++a) values[a] = coarse[nodes[a]];
      for (const Local i : points_in(cell)) {
        if (is_out(i) && !freedom_) continue;
        const auto w = cells_.template weights<dimension>(i);
        Vec3 sum = Vec3::Zero();
        for (std::size_t a = 0; a < w.size(); ++a) sum += w[a] * values[a];
        fine[i] += is_out(i) ? freedom_->allowed(i, sum) : sum;
      }
    }
  });
}

template class SplineGrid<2, double>;
template void SplineGrid<2, double>::add(const SparseRows&, std::span<const double>);
template class SplineGrid<1, Mat3>;
template void SplineGrid<1, Mat3>::add(const SparseRows&, std::span<const double>);
template void SplineGrid<1, Mat3>::add(const SparseRows&, std::span<const Mat3>);
template void SplineGrid<1, Mat3>::add_rank_one(const std::array<Local, 4>&, const std::array<Vec3, 4>&);
template void SplineGrid<1, Mat3>::add_rank_one(const std::array<Local, 6>&, const std::array<Vec3, 6>&);

} // namespace taut
