#pragma once
#include "src/linear/vertex_matrix.hpp"

namespace taut {

/// The filtered matrix P A P + (I - P), where P leaves out the prescribed vertices [BW98 section 5].
class FilteredOperator {
public:
  explicit FilteredOperator(const DistributedMesh& mesh) : mesh_(mesh) {}

  void set(const VertexMatrix& matrix, std::span<const char> prescribed);

  /// y = (P A P + I - P) x over owned vertices. Collective over neighbours.
  void apply(std::span<const Vec3> x, std::span<Vec3> y) const;

  /// The diagonal blocks and their inverses, those of prescribed vertices being the identity; over owned
  /// vertices.
  void diagonal_blocks(std::span<Mat3> blocks) const;
  void inverse_diagonal_blocks(std::span<Mat3> blocks) const;

  const VertexMatrix& matrix() const { return *matrix_; }
  std::span<const char> prescribed() const { return prescribed_; }

private:
  const DistributedMesh& mesh_;
  const VertexMatrix* matrix_ = nullptr;
  std::span<const char> prescribed_;
  mutable std::vector<Vec3> x_, y_; // over local vertices
};

} // namespace taut
