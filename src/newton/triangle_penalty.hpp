#pragma once
#include "src/constraints/triangle_bounds.hpp"
#include "src/linear/vertex_matrix.hpp"

namespace taut {

/// What Newton's method on the whole step knows of the bounds of single triangles (TriangleBounds), |w| in
/// [1 - b, 1 + b] along warp and weft, while its equations keep averages: the energy
///
///     E = k/2 s^2 (| |w| - 1 | - b/2)^2     of a triangle that strains by more than b/2,
///
/// in kg m^2, with s the root of its area and k such that it is as stiff as the system is against it. So its
/// solves end near what the projection can keep, which does the rest. Without, they want strains of a fifth
/// in every step, and it takes the projection many iterations to undo them.
///
/// E is convex where it pulls; of where it pushes, the derivative leaves out what is not. Every rank has all
/// triangles at its own vertices.
class TrianglePenalty {
public:
  /// Not collective.
  TrianglePenalty(const Cloth& cloth, const config::Inextensibility& options);

  /// For a step; `metric` is the inverse metric W of the system without the penalty, 1/kg of local vertices,
  /// 0 if held. Not collective.
  void begin(std::span<const double> metric);

  /// At positions `x` of local vertices, after `dt` with velocities `v`: subtracts the gradient of E from
  /// `residual`, kg m, of own vertices, and adds what the last `terms` hold back. Not collective.
  void evaluate(std::span<const Vec3> x, std::span<const Vec3> v, double dt, std::span<Vec3> residual) const;

  /// The second derivative of E at `x`, to be held in the system from now on. Not collective.
  std::vector<VertexMatrix::RankOne> terms(std::span<const Vec3> x);

private:
  struct Direction {
    TangentStencil stencil;
    double scale;         ///< s, m
    double stiffness = 0; ///< k, kg
  };
  struct Answer {
    Vec3 direction; ///< w / |w|
    double pull;    ///< kg m, in units of s c; negative: a push
    double across;  ///< kg, how stiff it is across w
  };
  Answer answer(const Direction& d, std::span<const Vec3> x) const;

  double free_; ///< b/2
  std::vector<Direction> directions_;
  std::vector<VertexMatrix::RankOne> held_;
};

} // namespace taut
