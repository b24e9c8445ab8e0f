#pragma once
#include "partition/index_map.hpp"
#include "src/linear/sparse_rows.hpp"
#include "src/linear/spline_basis.hpp"

#include <unordered_map>

namespace taut {

/// The nodes of a coarse grid, and which of them a matrix between points couples: what a SplineGrid knows
/// before there are any values. It lies in space and depends neither on the partition nor on the mesh. The
/// fewer nodes there are, the fewer ranks own them.
template<int degree>
class SplineNodes {
public:
  /// For a matrix with these rows between `points` (m, local, the owned ones first), with nodes `spacing` m
  /// apart. Collective.
  SplineNodes(MPI_Comm comm, const SparseRows& rows, std::span<const Vec3> points, double spacing);

  Global total() const { return nodes_.total; }    ///< nodes over all ranks
  const IndexMap& nodes() const { return nodes_; } ///< their keys are the original numbers
  const Halo& halo() const { return halo_; }
  const std::vector<Vec3>& points() const { return points_; } ///< of local nodes, m
  SparseRows rows() const { return {std::span(offsets_).first(std::size_t(nodes_.owned) + 1), columns_}; }
  const SplineBasis<degree>& cells() const { return cells_; }

protected:
  std::span<const Local> nodes_of(Local cell) const {
    return std::span(cell_nodes_).subspan(std::size_t(cell) * per_cell_, per_cell_);
  }
  std::span<const Local> near(Local cell) const { return part(near_, near_offsets_, cell); }
  std::span<const Local> reach(Local cell) const { return part(reach_, reach_offsets_, cell); }
  std::span<const Local> points_in(Local cell) const { return part(cell_points_, cell_offsets_, cell); }

  Local own_points() const { return Local(cell_points_.size()); }

  /// Where the nodes of each cell near this one are in its reach.
  const Local* places_near(Local cell) const {
    return near_places_.data() + std::size_t(near_offsets_[cell]) * per_cell_;
  }

  SplineBasis<degree> cells_;
  std::size_t per_cell_; ///< nodes

  // Rows of all local nodes; of ghosts, what this rank adds to their owners' rows.
  std::vector<std::int64_t> offsets_;
  std::vector<Local> columns_;
  Plan to_owners_;
  IndexMap nodes_;
  Halo halo_;
  std::vector<std::int64_t> near_offsets_{0};

private:
  using Coupling = std::pair<Global, Global>; ///< keys of a row's and a column's node

  static std::span<const Local> part(const std::vector<Local>& all, const std::vector<std::int64_t>& offsets,
                                     Local cell) {
    return std::span(all).subspan(std::size_t(offsets[cell]), std::size_t(offsets[cell + 1] - offsets[cell]));
  }
  void sort_points(const SparseRows& rows);
  void find_near_cells(const SparseRows& rows);
  std::vector<Coupling> couplings() const;
  void number_nodes(MPI_Comm comm, std::vector<Coupling>& own);
  void find_reach();
  void make_rows(MPI_Comm comm, const std::vector<Coupling>& own);

  // Owned points by cell, and of each cell those with couplings to its points, itself included.
  std::vector<std::int64_t> cell_offsets_, reach_offsets_{0};
  std::vector<Local> cell_points_, near_;
  std::vector<Local> reach_;       ///< all nodes of the cells near a cell, ascending
  std::vector<Local> near_places_; ///< of the nodes of each cell near it, in its reach

  std::unordered_map<Global, Local> local_; ///< by key; for set-up
  std::vector<Vec3> points_;
  std::vector<Local> cell_nodes_;
};

extern template class SplineNodes<1>;
extern template class SplineNodes<2>;

} // namespace taut
