#include "src/linear/incomplete_cholesky.hpp"

#include <algorithm>

namespace taut {

IncompleteCholesky::IncompleteCholesky(const SparseRows& rows) {
  for (Local row = 0; row < rows.size(); ++row) {
    for (const Local column : rows.columns(row))
      if (column < row) columns_.push_back(column);
    offsets_.push_back(std::int32_t(columns_.size()));
  }
  columns_.shrink_to_fit();
  lower_.resize(columns_.size());
  diagonal_.resize(rows.size());
}

void IncompleteCholesky::factor(const SparseRows& rows, std::span<const double> values) {
  constexpr double least_shift = 0.1; // a smaller one leaves factors that are whole but poor
  for (double shift = 0;; shift = std::max(2 * shift, least_shift)) {
    collect(rows, values);
    for (double& d : diagonal_) d *= 1 + shift;
    if (eliminate()) return;
  }
}

/// The lower triangle, and the diagonal with its part of the positive couplings.
void IncompleteCholesky::collect(const SparseRows& rows, std::span<const double> values) {
  constexpr double part = 0.2; // from a tenth on no pivot vanishes; from two fifths on iterations grow
  auto next = lower_.begin();
  auto value = values.begin();
  for (Local row = 0; row < rows.size(); ++row) {
    double diagonal = 0, positive = 0;
    for (const Local column : rows.columns(row)) {
      if (column == row)
        diagonal = *value;
      else
        positive += std::max(*value, 0.0);
      if (column < row) *next++ = float(*value);
      ++value;
    }
    diagonal_[row] = (diagonal > 0 ? diagonal : 1 - diagonal) + part * positive;
  }
}

/// False if a pivot comes out too small.
bool IncompleteCholesky::eliminate() {
  constexpr double smallest_pivot = 0.1; // of the diagonal it started from
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
          sum -= double(lower_[k]) * lower_[m] * diagonal_[columns_[k]];
          ++k, ++m;
        }
      }
      lower_[a] = float(sum / diagonal_[j]);
      pivot -= lower_[a] * sum;
    }
    if (pivot < smallest_pivot * diagonal_[i]) return false;
    diagonal_[i] = pivot;
  }
  return true;
}

void IncompleteCholesky::solve(std::span<const Vec3> b, std::span<Vec3> x) const {
  const Local rows = Local(diagonal_.size());
  for (Local i = 0; i < rows; ++i) {
    Vec3 sum = b[i];
    for (std::int32_t a = offsets_[i]; a < offsets_[i + 1]; ++a) sum -= double(lower_[a]) * x[columns_[a]];
    x[i] = sum;
  }
  for (Local i = 0; i < rows; ++i) x[i] /= diagonal_[i];
  for (Local i = rows; i-- > 0;) {
    const Vec3 solved = x[i];
    for (std::int32_t a = offsets_[i]; a < offsets_[i + 1]; ++a) x[columns_[a]] -= double(lower_[a]) * solved;
  }
}

} // namespace taut
