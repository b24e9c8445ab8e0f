#pragma once
#include "partition/index_map.hpp"
#include "src/linear/sparse_rows.hpp"
#include "src/linear/spline_basis.hpp"

#include <unordered_map>

namespace taut {

/// A coarse grid for a scalar matrix S between points: functions are coarse if they are sums of the splines
/// of a SplineBasis, u = P c, and their matrix is P^T S P. The grid lies in space and depends neither on the
/// partition nor on the mesh. The fewer nodes there are, the fewer ranks own them.
class SplineGrid {
public:
  /// For a matrix with these rows between `points` (m, local, the owned ones first), with nodes `spacing` m
  /// apart. Collective.
  SplineGrid(MPI_Comm comm, const SparseRows& rows, std::span<const Vec3> points, double spacing);

  /// Makes P^T S P from the values of S in the order of its rows, which are the ones given before, without
  /// the points that are `held` (not 0; empty: none). Both `rows` and `held` must live as long as the grid is
  /// used. Collective over neighbours.
  void set(const SparseRows& rows, std::span<const double> values, std::span<const char> held);

  /// coarse = P^T fine: from owned points to owned nodes; `coarse` is over local nodes. Collective over
  /// neighbours.
  void gather(std::span<const Vec3> fine, std::vector<Vec3>& coarse) const;

  /// fine += P coarse, from owned nodes to owned points; updates the ghosts of `coarse`. Collective over
  /// neighbours.
  void add_spread(std::vector<Vec3>& coarse, std::span<Vec3> fine) const;

  Global total() const { return nodes_.total; } ///< nodes over all ranks
  const IndexMap& nodes() const { return nodes_; }
  const std::vector<Vec3>& points() const { return points_; } ///< of local nodes, m
  SparseRows rows() const { return {std::span(offsets_).first(std::size_t(nodes_.owned) + 1), columns_}; }
  std::span<const double> values() const { return values_; } ///< of P^T S P, in the order of the rows

private:
  using Coupling = std::pair<Global, Global>; ///< keys of a row's and a column's node

  void sort_points(const SparseRows& rows);
  void find_near_cells(const SparseRows& rows);
  std::vector<Coupling> couplings() const;
  void number_nodes(MPI_Comm comm, std::vector<Coupling>& own);
  void find_reach();
  void make_rows(MPI_Comm comm, const std::vector<Coupling>& own);
  bool is_held(Local point) const { return !held_.empty() && held_[point]; }
  template<int dimension>
  void add_cell(const SparseRows& rows, std::span<const double> values, Local cell);
  std::span<const Local> nodes_of(Local cell) const {
    return std::span(cell_nodes_).subspan(std::size_t(cell) * per_cell_, per_cell_);
  }
  std::span<const Local> near(Local cell) const {
    return std::span(near_).subspan(std::size_t(near_offsets_[cell]),
                                    std::size_t(near_offsets_[cell + 1] - near_offsets_[cell]));
  }
  std::span<const Local> reach(Local cell) const {
    return std::span(reach_).subspan(std::size_t(reach_offsets_[cell]),
                                     std::size_t(reach_offsets_[cell + 1] - reach_offsets_[cell]));
  }
  std::span<const Local> points_in(Local cell) const {
    return std::span(cell_points_)
        .subspan(std::size_t(cell_offsets_[cell]),
                 std::size_t(cell_offsets_[cell + 1] - cell_offsets_[cell]));
  }

  SplineBasis cells_;
  std::size_t per_cell_; ///< nodes
  std::span<const char> held_;

  // Owned points by cell, and of each cell those with couplings to its points, itself included.
  std::vector<std::int64_t> cell_offsets_, near_offsets_{0}, reach_offsets_{0};
  std::vector<Local> cell_points_, near_;
  std::vector<Local> reach_;              ///< all nodes of the cells near a cell, ascending
  std::vector<std::uint8_t> near_places_; ///< of the nodes of each cell near it, in its reach

  IndexMap nodes_;                          ///< their keys are the original numbers
  std::unordered_map<Global, Local> local_; ///< by key; for set-up
  Halo halo_;
  std::vector<Vec3> points_;
  std::vector<Local> cell_nodes_;

  // Rows of all local nodes; of ghosts, what this rank adds to their owners' rows.
  std::vector<std::int64_t> offsets_;
  std::vector<Local> columns_;
  std::vector<double> values_;
  Plan to_owners_;
  std::vector<double> block_, row_; ///< room for one cell
};

} // namespace taut
