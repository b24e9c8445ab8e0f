#pragma once
#include "src/linear/spline_nodes.hpp"
#include "src/state/freedom.hpp"

#include <concepts>
#include <tuple>

namespace taut {

/// A coarse grid for a matrix A between points, of numbers (double), or of 3 x 3 blocks (Mat3): functions are
/// coarse if they are sums of the splines of a SplineBasis, u = P c, and their matrix is P^T A P. Points that
/// are held are left out. Where there are blocks, a point that may move in some directions is projected onto
/// them: the matrix is P^T S A S P, and what is said of P below holds of S P.
///
/// The matrix is filled by `start`, any number of `add...`, and `finish`.
template<int degree, class Value>
class SplineGrid : public SplineNodes<degree> {
public:
  static constexpr bool has_blocks = std::same_as<Value, Mat3>;

  /// As SplineNodes.
  SplineGrid(MPI_Comm comm, const SparseRows& rows, std::span<const Vec3> points, double spacing);

  /// Zeros, where the points are left out that are `held` (not 0; empty: none), which must live as long as
  /// the grid is used. Not collective.
  void start(std::span<const char> held = {});
  /// The same, where points move as `freedom` lets them.
  void start(const Freedom& freedom) requires has_blocks {
    start(freedom.held());
    freedom_ = &freedom;
  }

  /// Adds what the rows of owned points give; couplings must be among those of the constructor's rows. For a
  /// grid of blocks a number stands for as many times the identity. Not collective.
  template<class Entry>
  void add(const SparseRows& rows, std::span<const Entry> values);

  /// Adds g g^T for the gradient g over some vertices, of which each is coupled to all others. Every rank
  /// that owns one of them adds it; only rows of its own points come from it. Not collective.
  template<std::size_t n>
  void add_rank_one(const std::array<Local, n>& vertices,
                    const std::array<Vec3, n>& gradient) requires has_blocks;

  /// Sums what ranks have added. Collective over neighbours.
  void finish();

  /// coarse = P^T fine: from owned points to owned nodes; `coarse` is over local nodes. Collective over
  /// neighbours.
  void gather(std::span<const Vec3> fine, std::vector<Vec3>& coarse) const;

  /// fine += P coarse, from owned nodes to owned points; updates the ghosts of `coarse`. Collective over
  /// neighbours.
  void add_spread(std::vector<Vec3>& coarse, std::span<Vec3> fine) const;

  std::span<const Value> values() const { return values_; } ///< of P^T A P, in the order of the rows

private:
  using Nodes = SplineNodes<degree>;
  using Nodes::cells_, Nodes::per_cell_, Nodes::offsets_, Nodes::columns_, Nodes::to_owners_, Nodes::nodes_,
      Nodes::halo_, Nodes::near_offsets_, Nodes::nodes_of, Nodes::near, Nodes::reach, Nodes::points_in,
      Nodes::own_points, Nodes::places_near;

  /// The part of a gradient, seen from the nodes of one cell.
  template<int dimension>
  struct CellPart {
    Local cell;
    bool has_own;
    std::array<Vec3, SplineBasis<degree>::nodes_of_cell(dimension)> all,
        own; ///< of all points, of owned ones
  };

  bool is_out(Local point) const { return !held_.empty() && held_[point]; }
  template<int dimension, class Entry>
  void add_cell(const SparseRows& rows, std::span<const Entry> values, Local cell);
  template<int dimension, class Entry>
  void add_sliding(const SparseRows& rows, std::span<const Entry> values);
  template<int dimension, std::size_t n>
  void add_gradient(const std::array<Local, n>& vertices, const std::array<Vec3, n>& gradient);
  template<int dimension>
  void add_block(Local row_point, Local column_point, const Mat3& block);
  const std::int32_t* slots_between(Local cell, Local other) const;
  void find_slots();

  std::span<const char> held_; ///< not 0 for sliding points either
  const Freedom* freedom_ = nullptr;
  std::vector<Value> values_;
  std::vector<std::int32_t> near_slots_; ///< of all pairs of nodes of a cell and of each near it; for blocks

  // Room for one cell.
  template<class Entry>
  struct Room {
    std::vector<Entry> block, row;
  };
  std::tuple<Room<double>, Room<Mat3>> room_;
};

extern template class SplineGrid<2, double>;
extern template class SplineGrid<1, Mat3>;

} // namespace taut
