#pragma once
#include "src/linear/vertex_matrix.hpp"
#include "src/state/freedom.hpp"

namespace taut {

/// The filtered matrix S A S + d (I - S), where S leaves out the directions that are prescribed [BW98 section
/// 5; the projected form of Ascher and Boxerman 2003]. d is 1 for a vertex that is held, and the vertex's
/// diagonal entry of B for one that may move in some directions: there preconditioners mix the directions.
class FilteredOperator {
public:
  explicit FilteredOperator(const DistributedMesh& mesh) : mesh_(mesh) {}

  void set(const VertexMatrix& matrix, const Freedom& freedom);

  /// y = (S A S + d (I - S)) x over owned vertices. Collective over neighbours.
  void apply(std::span<const Vec3> x, std::span<Vec3> y) const;

  /// A x over local vertices, of which the owned part is meaningful: nothing left out. `x` over local
  /// vertices, ghosts current. Valid until the next product.
  std::span<const Vec3> unfiltered_product(std::span<const Vec3> x) const;

  /// The diagonal blocks and their inverses, of held vertices the identity; over owned
  /// vertices.
  void diagonal_blocks(std::span<Mat3> blocks) const;
  void inverse_diagonal_blocks(std::span<Mat3> blocks) const;

  /// 3 / trace of the diagonal blocks, in 1/kg, 0 where held: W of Newton's method; over local vertices.
  /// Collective over neighbours.
  void inverse_means(std::vector<double>& means) const;

  /// All blocks, in the order of the matrix's pattern; but for terms between vertices that are no neighbours
  /// (VertexMatrix::set_far).
  void blocks(std::span<Mat3> blocks) const;

  const VertexMatrix& matrix() const { return *matrix_; }
  const Freedom& freedom() const { return *freedom_; }

  /// S A_ij S or, on the diagonal, with d (I - S) added; for rows of owned vertices.
  Mat3 filtered(Local row, Local column, const Mat3& block) const;

private:
  double scale(Local vertex) const;

  const DistributedMesh& mesh_;
  const VertexMatrix* matrix_ = nullptr;
  const Freedom* freedom_ = nullptr;
  mutable std::vector<Vec3> x_, y_; // over local vertices
};

} // namespace taut
