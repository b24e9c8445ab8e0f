#include "src/linear/filtered_operator.hpp"

#include <Eigen/LU>

#include <algorithm>

namespace taut {

void FilteredOperator::set(const VertexMatrix& matrix, std::span<const char> prescribed) {
  matrix_ = &matrix;
  prescribed_ = prescribed;
  x_.resize(mesh_.vertices.size());
  y_.resize(mesh_.vertices.size());
}

void FilteredOperator::apply(std::span<const Vec3> x, std::span<Vec3> y) const {
  const Local owned = mesh_.vertices.owned;
  for (Local i = 0; i < owned; ++i) x_[i] = prescribed_[i] ? Vec3(Vec3::Zero()) : x[i];
  mesh_.vertex_halo.update(x_);
  matrix_->multiply(x_, y_);
  for (Local i = 0; i < owned; ++i) y[i] = prescribed_[i] ? x[i] : y_[i];
}

void FilteredOperator::diagonal_blocks(std::span<Mat3> blocks) const {
  matrix_->diagonal_blocks(blocks);
  for (Local i = 0; i < mesh_.vertices.owned; ++i)
    if (prescribed_[i]) blocks[i].setIdentity();
}

void FilteredOperator::inverse_diagonal_blocks(std::span<Mat3> blocks) const {
  diagonal_blocks(blocks);
  for (Mat3& block : blocks) block = block.inverse().eval();
}

} // namespace taut
