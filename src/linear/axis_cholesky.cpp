#include "src/linear/axis_cholesky.hpp"

#include <algorithm>

namespace taut {

AxisCholesky::AxisCholesky(const Pattern& pattern) : pattern_(pattern) {
  for (Local row = 0; row < pattern.rows(); ++row) {
    for (const Local column : pattern.columns(row))
      if (column < row) columns_.push_back(column);
    offsets_.push_back(std::int32_t(columns_.size()));
  }
  lower_.resize(columns_.size());
  diagonal_.resize(pattern.rows());
}

void AxisCholesky::factor(const VertexMatrix& matrix, const Freedom& freedom) {
  constexpr double least_shift = 0.1; // a smaller one leaves factors that are whole but poor
  for (double shift = 0;; shift = std::max(2 * shift, least_shift)) {
    collect(matrix);
    leave_out(freedom);
    for (double& d : diagonal_) d = (1 + shift) * (d > 0 ? d : 1 - d);
    if (eliminate()) return;
  }
}

/// False if a pivot comes out too small, as may happen where bending rules: its couplings are not all
/// negative.
bool AxisCholesky::eliminate() {
  constexpr double smallest_pivot = 0.3; // of the diagonal it started from
  for (Local i = 0; i < Local(diagonal_.size()); ++i) {
    double pivot = diagonal_[i];
    for (std::int32_t a = offsets_[i]; a < offsets_[i + 1]; ++a) {
      const Local j = columns_[a];
      double sum = lower_[a]; // L_ij D_j, less what the columns before j give
      for (std::int32_t k = offsets_[i], m = offsets_[j]; k < a && m < offsets_[j + 1];) {
        if (columns_[k] < columns_[m])
          ++k;
        else if (columns_[m] < columns_[k])
          ++m;
        else {
          sum -= lower_[k] * lower_[m] * diagonal_[columns_[k]];
          ++k, ++m;
        }
      }
      lower_[a] = sum / diagonal_[j];
      pivot -= lower_[a] * sum;
    }
    if (pivot < smallest_pivot * diagonal_[i]) return false;
    diagonal_[i] = pivot;
  }
  return true;
}

/// The lower triangle of the scalar matrix.
void AxisCholesky::collect(const VertexMatrix& matrix) {
  auto next = lower_.begin();
  for (Local row = 0; row < pattern_.rows(); ++row) {
    const double* value = matrix.values().data() + pattern_.offset(row);
    for (const Local column : pattern_.columns(row)) {
      if (column < row)
        *next++ = *value;
      else if (column == row)
        diagonal_[row] = *value;
      ++value;
    }
  }
  matrix.for_each_rank_one([&](const auto& r) {
    for (std::size_t a = 0; a < r.vertices.size(); ++a) {
      const Local row = r.vertices[a];
      if (row >= pattern_.rows()) continue;
      diagonal_[row] += r.gradient[a].squaredNorm() / 3.0;
      for (std::size_t b = 0; b < r.vertices.size(); ++b)
        if (r.vertices[b] < row) *entry(row, r.vertices[b]) += r.gradient[a].dot(r.gradient[b]) / 3.0;
    }
  });
  if (!matrix.has_far()) return;
  for (Local row = 0; row < pattern_.rows(); ++row)
    diagonal_[row] += matrix.far_diagonal_blocks()[row].trace() / 3.0;
}

void AxisCholesky::leave_out(const Freedom& freedom) {
  for (Local row = 0; row < pattern_.rows(); ++row) {
    if (freedom.is_held(row)) diagonal_[row] = 1.0;
    for (std::int32_t a = offsets_[row]; a < offsets_[row + 1]; ++a)
      if (freedom.is_held(row) || freedom.is_held(columns_[a])) lower_[a] = 0.0;
  }
}

double* AxisCholesky::entry(Local row, Local column) {
  const auto begin = columns_.begin() + offsets_[row], end = columns_.begin() + offsets_[row + 1];
  return lower_.data() + (std::lower_bound(begin, end, column) - columns_.begin());
}

void AxisCholesky::solve(std::span<const Vec3> b, std::span<Vec3> x) const {
  const Local rows = Local(diagonal_.size());
  for (Local i = 0; i < rows; ++i) {
    Vec3 sum = b[i];
    for (std::int32_t a = offsets_[i]; a < offsets_[i + 1]; ++a) sum -= lower_[a] * x[columns_[a]];
    x[i] = sum;
  }
  for (Local i = 0; i < rows; ++i) x[i] /= diagonal_[i];
  for (Local i = rows; i-- > 0;) {
    const Vec3 solved = x[i];
    for (std::int32_t a = offsets_[i]; a < offsets_[i + 1]; ++a) x[columns_[a]] -= lower_[a] * solved;
  }
}

} // namespace taut
