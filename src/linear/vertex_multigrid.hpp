#pragma once
#include "src/linear/filtered_operator.hpp"
#include "src/linear/spline_grid.hpp"

#include <Eigen/Cholesky>

#include <memory>

namespace taut {

/// Geometric multigrid for the filtered velocity matrix A: linear splines on nested grids in space over the
/// rest shape, with 3 x 3 blocks between their nodes. A grid depends neither on the partition nor on how
/// vertices are numbered, and neither does a cycle, but for round-off.
///
/// A cycle goes down without any smoothing, so without any product: P^T b is all that a grid needs. On the
/// way up each grid takes a step of Chebyshev's polynomials of the fourth kind in D^-1 A [Lottes 2022], and
/// the vertices two. (For cloth of 141 x 141 vertices between two pins Newton's method took 13, 8, 9
/// iterations a step with one, two, three; smaller D, of which fewer couplings are part, made no difference.)
class VertexMultigrid {
public:
  /// Grids of linear splines at 3, 9, 27, ... mean edge lengths, one at least, until at most 50 nodes are
  /// left. Both must outlive the multigrid. Collective.
  VertexMultigrid(const DistributedMesh& mesh, const Pattern& pattern);

  /// Makes the matrices P^T S A S P of all grids, what smooths, and the factor of the coarsest. `matrix` must
  /// live, and stay as it is, as long as it is used. Contact between vertices that are no neighbours is told
  /// to the grids by its diagonal blocks. Collective.
  void set(const FilteredOperator& matrix);

  /// x = A^-1 b, nearly, over owned vertices: one cycle. Collective.
  void solve(std::span<const Vec3> b, std::span<Vec3> x) const;

  /// The same, but what the grids from `k` on would give is `start`, over owned nodes of grid k: brought up
  /// with smoothing on grids k - 1, ..., 0 and on the vertices; not on grid k. Collective over neighbours.
  void solve(std::span<const Vec3> b, std::size_t k, std::span<const Vec3> start, std::span<Vec3> x) const;

  /// coarse = P^T S b over owned nodes of grid k. Collective over neighbours.
  void restrict_to(std::size_t k, std::span<const Vec3> b, std::vector<Vec3>& coarse) const;

  std::size_t levels() const { return levels_.size(); } ///< grids only; 0 is the finest
  const SplineGrid<1, Mat3>& grid(std::size_t k) const { return levels_[k]->grid; }
  double spacing(std::size_t k) const { return grid(k).cells().spacing(); } ///< m

  /// Calls visit(key, weight) for the nodes of grid k that make up the displacement at a local vertex, ghosts
  /// included: (P_k u)_i = S_i sum weight u_node. Keys are those in grid(k).nodes().original, which not every
  /// rank that asks need have among its nodes; no weight is 0. Not collective.
  template<class Visit>
  void for_each_weight(std::size_t k, Local vertex, Visit&& visit) const {
    grid(k).cells().for_each_weight(mesh_.rest_positions[vertex], visit);
  }

private:
  struct Level {
    SplineGrid<1, Mat3> grid;
    std::vector<Mat3> smoother;     ///< D^-1 of owned nodes
    mutable std::vector<Vec3> b, x; ///< over local nodes
    mutable std::vector<Vec3> step; ///< over owned nodes
  };

  void make_matrices();
  void make_vertex_smoother();
  static void make_smoother(Level& level);
  void factor_coarsest();
  void restrict_all(std::size_t grids, std::span<const Vec3> b) const;
  void solve_coarsest() const;
  void rise_from(std::size_t k, std::span<const Vec3> b, std::span<Vec3> x) const;
  void smooth(const Level& level) const;

  const DistributedMesh& mesh_;
  const Pattern& pattern_;
  const FilteredOperator* matrix_ = nullptr;
  std::vector<std::unique_ptr<Level>> levels_;
  std::vector<Mat3> smoother_;                  ///< D^-1 of owned vertices
  Eigen::LLT<Eigen::MatrixXd> coarsest_;        ///< the whole matrix, on every rank
  mutable std::vector<double> coarsest_values_; ///< of all its nodes
  mutable std::vector<Vec3> step_, product_;    ///< over owned vertices
};

} // namespace taut
