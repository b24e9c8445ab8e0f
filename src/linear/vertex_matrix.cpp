#include "src/linear/vertex_matrix.hpp"

#include <algorithm>

namespace taut {

void VertexMatrix::clear() {
  std::fill(values_.begin(), values_.end(), 0.0);
  rank_ones_.clear();
  wide_rank_ones_.clear();
  near_.clear();
  far_.reset();
}

void VertexMatrix::multiply(std::span<const Vec3> x, std::span<Vec3> y) const {
  const Local rows = pattern_.rows();
  const double* value = values_.data();
  for (Local row = 0; row < rows; ++row) {
    double s0 = 0, s1 = 0, s2 = 0;
    for (const Local column : pattern_.columns(row)) {
      const double b = *value++;
      const Vec3& xc = x[column];
      s0 += b * xc[0];
      s1 += b * xc[1];
      s2 += b * xc[2];
    }
    y[row] = Vec3(s0, s1, s2);
  }
  // Entries of ghosts are not wanted but cheaper to add than to avoid.
  for_each_rank_one([&](const auto& r) {
    constexpr std::size_t n = std::tuple_size_v<std::decay_t<decltype(r.vertices)>>;
    double s = 0;
    for (std::size_t a = 0; a < n; ++a) s += r.gradient[a].dot(x[r.vertices[a]]);
    for (std::size_t a = 0; a < n; ++a) y[r.vertices[a]] += s * r.gradient[a];
  });
  if (far_) far_->add_product(x, y);
}

void VertexMatrix::diagonal_blocks(std::span<Mat3> blocks) const {
  for (Local row = 0; row < pattern_.rows(); ++row)
    blocks[row] = Mat3::Identity() * values_[pattern_.diagonal(row)];
  for_each_rank_one([&](const auto& r) {
    for (std::size_t a = 0; a < r.vertices.size(); ++a)
      if (r.vertices[a] < pattern_.rows()) blocks[r.vertices[a]] += r.gradient[a] * r.gradient[a].transpose();
  });
  if (!far_) return;
  for (Local row = 0; row < pattern_.rows(); ++row) blocks[row] += far_->diagonal_blocks()[row];
}

} // namespace taut
