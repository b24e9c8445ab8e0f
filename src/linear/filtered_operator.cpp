#include "src/linear/filtered_operator.hpp"

#include <Eigen/LU>

#include <algorithm>

namespace taut {

void FilteredOperator::set(const VertexMatrix& matrix, const Freedom& freedom) {
  matrix_ = &matrix;
  freedom_ = &freedom;
  x_.resize(mesh_.vertices.size());
  y_.resize(mesh_.vertices.size());
}

/// d of the vertex.
double FilteredOperator::scale(Local vertex) const {
  return freedom_->is_held(vertex) ? 1.0 : matrix_->values()[matrix_->pattern().diagonal(vertex)];
}

void FilteredOperator::apply(std::span<const Vec3> x, std::span<Vec3> y) const {
  const Local owned = mesh_.vertices.owned;
  for (Local i = 0; i < owned; ++i) x_[i] = freedom_->allowed(i, x[i]);
  mesh_.vertex_halo.update(x_);
  matrix_->multiply(x_, y_);
  for (Local i = 0; i < owned; ++i)
    y[i] = freedom_->is_free(i) ? y_[i]
                                : Vec3(freedom_->allowed(i, y_[i]) + scale(i) * freedom_->denied(i, x[i]));
}

std::span<const Vec3> FilteredOperator::unfiltered_product(std::span<const Vec3> x) const {
  matrix_->multiply(x, y_);
  return y_;
}

Mat3 FilteredOperator::filtered(Local row, Local column, const Mat3& block) const {
  if (freedom_->is_free(row) && freedom_->is_free(column)) return block;
  const Mat3 s = freedom_->projector(row);
  const Mat3 inner = s * block * freedom_->projector(column);
  return row == column ? Mat3(inner + scale(row) * (Mat3::Identity() - s)) : inner;
}

void FilteredOperator::diagonal_blocks(std::span<Mat3> blocks) const {
  matrix_->diagonal_blocks(blocks);
  for (Local i = 0; i < mesh_.vertices.owned; ++i) blocks[i] = filtered(i, i, blocks[i]);
}

void FilteredOperator::inverse_diagonal_blocks(std::span<Mat3> blocks) const {
  diagonal_blocks(blocks);
  for (Mat3& block : blocks) block = block.inverse().eval();
}

void FilteredOperator::inverse_means(std::vector<double>& means) const {
  std::vector<Mat3> blocks(mesh_.vertices.owned);
  diagonal_blocks(blocks);
  for (Local i = 0; i < mesh_.vertices.owned; ++i)
    means[i] = freedom_->is_held(i) ? 0.0 : 3.0 / blocks[i].trace();
  mesh_.vertex_halo.update(means);
}

void FilteredOperator::blocks(std::span<Mat3> blocks) const {
  const Pattern& pattern = matrix_->pattern();
  for (std::size_t k = 0; k < blocks.size(); ++k) blocks[k] = matrix_->values()[k] * Mat3::Identity();
  matrix_->for_each_rank_one([&](const auto& r) {
    for (std::size_t a = 0; a < r.vertices.size(); ++a) {
      if (!mesh_.owns_vertex(r.vertices[a])) continue;
      for (std::size_t b = 0; b < r.vertices.size(); ++b)
        blocks[pattern.slot(r.vertices[a], r.vertices[b])] += r.gradient[a] * r.gradient[b].transpose();
    }
  });
  auto block = blocks.begin();
  for (Local row = 0; row < pattern.rows(); ++row)
    for (const Local column : pattern.columns(row)) {
      *block = filtered(row, column, *block);
      ++block;
    }
}

} // namespace taut
