#pragma once
#include "partition/comm.hpp"
#include "partition/types.hpp"

#include <array>

namespace taut {

/// Points in the cells of a grid of cubes, and the tensor products of quadratic B-splines on it. Each cell
/// has three splines along every axis, and no more than one along an axis in which the points lie within half
/// a cell: nine for a flat sheet, 27 in space. A quadratic spline has a curvature everywhere, so what bends
/// smoothly is told without creases; and splines sum up to one, and to any linear function.
///
/// Node (i, j, k) is the centre of the spline that begins at the corner of cell (i, j, k) - 2; its key packs
/// these numbers.
class SplineCells {
public:
  using Weights = std::array<double, 27>;

  /// Cells of this `spacing`, in m, around local points. Collective.
  SplineCells(MPI_Comm comm, std::span<const Vec3> points, double spacing);

  Local size() const { return Local(first_.size()); } ///< number of cells that hold points
  int nodes_of_cell() const { return count_[0] * count_[1] * count_[2]; }
  std::vector<Global> node_keys(Local cell) const; ///< in the order of the weights
  Vec3 node_point(Global key) const;               ///< m

  Local cell_of(Local point) const { return places_[point].cell; }
  /// Of the splines of the point's cell, at the point.
  void weigh(Local point, Weights& weights) const;

private:
  struct Place {
    Local cell;
    std::array<float, 3> at; ///< within the cell, 0 to 1
  };

  Vec3 origin_;
  double spacing_;
  std::array<int, 3> count_;                 ///< splines of a cell along each axis
  std::vector<Place> places_;                ///< of local points
  std::vector<std::array<Global, 3>> first_; ///< the lowest node of each cell
};

} // namespace taut
