#pragma once
#include "partition/comm.hpp"
#include "partition/types.hpp"

#include <array>

namespace taut {

/// Points in the cells of a grid of cubes, and the tensor products of B-splines of this degree, 1 or 2, on
/// it. Each cell has degree + 1 splines along every axis, and no more than one along an axis in which the
/// points lie within half a cell. Splines sum up to one, and to any linear function.
///
/// Quadratic splines, nine a cell for a flat sheet and 27 in space, have a curvature everywhere, so what
/// bends smoothly is told without creases. Linear ones, four and eight, are nested: grids over the same box
/// whose spacings are multiples of each other begin at the same corner, and a spline of the coarser one is a
/// sum of those of the finer one.
///
/// Axes along which there is but one spline come last in all that follows. Node (i, j, k) is the centre of
/// the spline that begins at the corner of cell (i, j, k) - degree; its key packs these numbers.
template<int degree>
class SplineBasis {
public:
  /// Cells of this `spacing`, in m, around local points. Collective.
  SplineBasis(MPI_Comm comm, std::span<const Vec3> points, double spacing);

  Local size() const { return Local(first_.size()); } ///< number of cells that hold points
  int dimension() const { return dimension_; }        ///< number of axes with several splines a cell
  double spacing() const { return spacing_; }         ///< m
  static constexpr std::size_t nodes_of_cell(int dimension) {
    return dimension == 0 ? 1 : (degree + 1) * nodes_of_cell(dimension - 1);
  }
  std::vector<Global> node_keys(Local cell) const; ///< in the order of the weights
  Vec3 node_point(Global key) const;               ///< m

  Local cell_of(Local point) const { return places_[point].cell; }

  /// Of the splines of the point's cell, at the point; `dimension` is that of the cells, so that loops over
  /// weights have a length that compilers know.
  template<int dimension>
  std::array<double, nodes_of_cell(dimension)> weights(Local point) const {
    return weights_at<dimension>(places_[point].at);
  }

  /// Calls visit(key, weight) for the splines that are not 0 at any point within the cells.
  template<class Visit>
  void for_each_weight(const Vec3& point, Visit&& visit) const {
    const Corner corner = corner_of(point);
    const std::vector<Global> keys = keys_from(corner.first);
    in_dimension([&](auto dimension) {
      const auto weights = weights_at<dimension>(corner.at);
      for (std::size_t a = 0; a < weights.size(); ++a)
        if (weights[a] != 0) visit(keys[a], weights[a]);
    });
  }

  /// work(dimension()), the dimension as a constant.
  template<class Work>
  void in_dimension(Work&& work) const {
    switch (dimension_) {
    case 0:
      return work(std::integral_constant<int, 0>());
    case 1:
      return work(std::integral_constant<int, 1>());
    case 2:
      return work(std::integral_constant<int, 2>());
    default:
      return work(std::integral_constant<int, 3>());
    }
  }

private:
  /// Within a cell, 0 to 1. In nested grids the weights of a coarse one are the products of those between
  /// grids, but for the round-off in these places; elsewhere single precision will do.
  using Within = std::array<std::conditional_t<degree == 1, double, float>, 3>;
  struct Corner {
    std::array<Global, 3> first; ///< the lowest node of the cell
    Within at;
  };
  struct Place {
    Local cell;
    Within at;
  };

  /// Of the splines of a cell along one axis.
  static std::array<double, degree + 1> along(double u) {
    if constexpr (degree == 1)
      return {1 - u, u};
    else
      return {0.5 * (1 - u) * (1 - u), 0.5 + u - u * u, 0.5 * u * u};
  }

  template<int dimension>
  static std::array<double, nodes_of_cell(dimension)> weights_at(const Within& at) {
    std::array<double, nodes_of_cell(dimension)> result;
    if constexpr (dimension == 0)
      result = {1.0};
    else {
      const auto last = along(at[dimension - 1]);
      const auto before = weights_at<dimension - 1>(at);
      for (std::size_t a = 0; a < before.size(); ++a)
        for (std::size_t b = 0; b < last.size(); ++b) result[last.size() * a + b] = before[a] * last[b];
    }
    return result;
  }

  int count(int axis) const { return axis < dimension_ ? degree + 1 : 1; } ///< splines of a cell
  Corner corner_of(const Vec3& point) const;
  std::vector<Global> keys_from(const std::array<Global, 3>& first) const;

  Vec3 origin_;
  double spacing_;
  int dimension_ = 0;
  std::array<int, 3> axes_;                  ///< of space, thin ones last
  std::array<Global, 3> last_{0, 0, 0};      ///< the highest cell along each of them
  std::vector<Place> places_;                ///< of local points
  std::vector<std::array<Global, 3>> first_; ///< the lowest node of each cell
};

extern template class SplineBasis<1>;
extern template class SplineBasis<2>;

} // namespace taut
