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
/// Axes along which there is but one spline come last in all that follows. Node (i, j, k) is the centre of
/// the spline that begins at the corner of cell (i, j, k) - 2; its key packs these numbers.
class SplineBasis {
public:
  /// Cells of this `spacing`, in m, around local points. Collective.
  SplineBasis(MPI_Comm comm, std::span<const Vec3> points, double spacing);

  Local size() const { return Local(first_.size()); } ///< number of cells that hold points
  int dimension() const { return dimension_; }        ///< number of axes with three splines a cell
  static constexpr std::size_t nodes_of_cell(int dimension) {
    return dimension == 0 ? 1 : 3 * nodes_of_cell(dimension - 1);
  }
  std::vector<Global> node_keys(Local cell) const; ///< in the order of the weights
  Vec3 node_point(Global key) const;               ///< m

  Local cell_of(Local point) const { return places_[point].cell; }

  /// Of the splines of the point's cell, at the point; `dimension` is that of the cells, so that loops over
  /// weights have a length that compilers know.
  template<int dimension>
  std::array<double, nodes_of_cell(dimension)> weights(Local point) const {
    std::array<double, nodes_of_cell(dimension)> result;
    if constexpr (dimension == 0)
      result = {1.0};
    else {
      const double u = places_[point].at[dimension - 1];
      const std::array<double, 3> along{0.5 * (1 - u) * (1 - u), 0.5 + u - u * u, 0.5 * u * u};
      const auto before = weights<dimension - 1>(point);
      for (std::size_t a = 0; a < before.size(); ++a)
        for (std::size_t b = 0; b < 3; ++b) result[3 * a + b] = before[a] * along[b];
    }
    return result;
  }

private:
  struct Place {
    Local cell;
    std::array<float, 3> at; ///< within the cell, 0 to 1
  };

  int count(int axis) const { return axis < dimension_ ? 3 : 1; } ///< splines of a cell

  Vec3 origin_;
  double spacing_;
  int dimension_ = 0;
  std::array<int, 3> axes_;                  ///< of space, thin ones last
  std::vector<Place> places_;                ///< of local points
  std::vector<std::array<Global, 3>> first_; ///< the lowest node of each cell
};

} // namespace taut
