#pragma once
#include "src/forces/folds.hpp"

namespace taut {

enum class RestAngle {
  flat,         ///< theta_0 = 0 [BW98 section 4.4]
  of_rest_shape ///< theta_0 that of the mesh at rest [Grinspun et al. 2003, discrete shells]
};

/// Bending by the angle theta over each edge between faces: E = sum 1/2 B |e|^2 / A (theta - theta_0)^2; on
/// triangles with z = |e| (theta - theta_0) / A, all angles of a triangle together (see folds_of). With the
/// angles of the rest shape these are discrete shells (the paper's k |e| / h with h a third of the mean
/// height is 3 k |e|^2 / A, so k = B/6); flat, and with B by the direction of the edge, it is BW98's bend
/// condition C = theta with k = B |e|^2 / A, which unlike a constant k keeps its stiffness on a finer mesh.
///
/// The gradient of theta is exact, |e| and the normals' lengths not held constant as in BW98. Of the Hessian
/// k (d d^T + (theta - theta_0) d2), d the gradient, the second term is left out: it is not definite. Damping
/// is -k_d d thetadot, k_d = damping times k [BW98 section 4.5]; its derivatives by positions are left out.
/// An edge folded by more than half a turn from flat is seen as folded to the other side.
class AngleBending : public Force {
public:
  /// `cloth` must outlive the force; `damping` is the stiffness-proportional damping in s.
  AngleBending(const Cloth& cloth, Folds folds, RestAngle rest, PerPiece<double> damping);

  std::string_view name() const override { return "bending"; }
  double energy(const State& state) const override;
  void add_to(StepSystem& system, const State& state) override;

private:
  /// The angle of a fold less that at rest, and its gradient.
  Dihedral bend_of(std::size_t fold, const State& state) const;
  /// Of the angle over fold k of a triangle in a row of it.
  double weight(const TriangleStencil& t, const std::array<double, 3>& row, std::size_t k) const {
    const HingeStencil& f = folds_.hinges[std::size_t(t.folds[k])];
    return row[k] * f.length() / f.area;
  }
  double damping_at(Local vertex) const { return damping_.of(cloth_.piece_of(vertex)).value_or(0); }
  void add_triangle(const TriangleStencil& triangle, const std::vector<Dihedral>& bends,
                    StepSystem& system) const;
  void add_hinge(const HingeStencil& fold, const Dihedral& bend, StepSystem& system) const;

  const Cloth& cloth_;
  Folds folds_;
  std::vector<double> rest_angles_; ///< of the folds
  PerPiece<double> damping_;        ///< s
};

/// Largest angle over an edge in the rest shape, in rad: 0 for a mesh that is flat at rest. Collective.
double largest_rest_angle(const Cloth& cloth, const Folds& folds);

} // namespace taut
