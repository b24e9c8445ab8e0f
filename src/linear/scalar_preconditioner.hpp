#pragma once
#include "src/linear/incomplete_cholesky.hpp"
#include "src/linear/spline_grid.hpp"
#include "src/linear/vertex_matrix.hpp"
#include "src/state/freedom.hpp"

#include <memory>

namespace taut {

/// A preconditioner for A = B (x) I_3 + sum g g^T that treats the three axes alike: it approximates the
/// inverse of the scalar matrix S = B + 1/3 sum <g, g^T>, whose entries are the means over the axes of those
/// of A, and is applied to the three axes in one sweep. A factor of S takes a twenty-seventh of the work that
/// the 3 x 3 blocks would.
///
/// Where inertia weighs enough, that is the incomplete Cholesky factorisation of S within each rank.
/// Elsewhere stiffness couples vertices further than a factor without fill can tell, and the corrections of
/// coarser and coarser SplineGrids are added to it [Bramble, Pasciak, Xu 1990]: then the iterations hardly
/// depend on how fine the mesh and how stiff the cloth is, nor on how many ranks there are.
class ScalarPreconditioner {
public:
  /// Both must outlive the preconditioner. Not collective.
  ScalarPreconditioner(const DistributedMesh& mesh, const Pattern& pattern);

  /// Held vertices get the identity; those that may move in some directions count as free. Depends on
  /// nothing but its arguments. Collective.
  void factor(const VertexMatrix& matrix, const Freedom& freedom);

  /// x = S^-1 b, nearly, over owned vertices. Collective over neighbours.
  void solve(std::span<const Vec3> b, std::span<Vec3> x) const;

private:
  struct Coarse {
    SplineGrid<2, double> grid;
    IncompleteCholesky factor;
    mutable std::vector<Vec3> b, x; // over local nodes
  };

  void collect(const VertexMatrix& matrix);
  void leave_out(const Freedom& freedom);
  bool needs_grids() const;
  void make_grids();
  void add_correction(std::size_t level, std::span<const Vec3> b, std::span<Vec3> x) const;

  const DistributedMesh& mesh_;
  const Pattern& pattern_;
  std::vector<double> values_; ///< of S, in the pattern's order
  std::vector<char> held_;     ///< of local vertices
  IncompleteCholesky fine_;
  std::vector<std::unique_ptr<Coarse>> grids_; ///< made when they are first needed
  bool uses_grids_ = false;
};

} // namespace taut
