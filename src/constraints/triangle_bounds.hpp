#pragma once
#include "src/constraints/constraint_set.hpp"
#include "src/forces/stretch.hpp"

namespace taut {

/// The tangents that have a bound: of triangles with no angle under 10 degrees. Slivers have none: across
/// themselves they stretch by much when their corners hardly move, and steps in which they must not became
/// ever shorter. `cells` are local. Not collective.
std::vector<Tangent> bounded_tangents(const Cloth& cloth, std::span<const Local> cells);

/// Bounds of what single triangles may strain where averages are kept (AveragedMetric), |w| in [1 - b, 1 + b]
/// along warp and weft, as one-sided rows beside those of a set. Triangles that strain by more than half of b
/// have rows: C = s (|w|^2 - t^2), with s the root of the triangle's area, which is to be at most 0 where it
/// is stretched, at least 0 where it is pressed. The target t is 1 +- 0.6 b; or where the triangle was at the
/// start of the step, if it was strained more, for to take it back farther would throw the cloth about. The
/// multipliers of these rows start from nothing in every step.
///
/// While the averages themselves are far from their limit, there are no rows: most of what triangles strain
/// is then the averages' to correct.
class TriangleBounds {
public:
  /// `cloth` must outlive the bounds. Not collective.
  TriangleBounds(const Cloth& cloth, const config::Inextensibility& options);

  /// For a step from `positions` in which vertices with these inverse masses (all local, see
  /// take_inverse_masses) move as `freedom` allows; all must outlive the step. Not collective.
  void start(std::span<const Vec3> positions, std::span<const double> inverse_mass, const Freedom& freedom);

  /// The step need not correct this part of what triangles strain beyond most of their bound. Not collective.
  void keep_strain(double part) { strain_kept_ = part; }

  /// Finds the rows at positions of local vertices, where the other rows strain by `of_others`, in limits;
  /// returns the largest strain of a triangle over its bound, infinite if one is not a number. Collective.
  double evaluate(std::span<const Vec3> x, double of_others);
  /// The same strain alone. Collective.
  double strain(std::span<const Vec3> x) const;
  /// Whether any rank has rows.
  bool any() const { return any_; }

  /// Of the rows of this rank; as ConstraintSet says.
  std::size_t rows() const { return rows_.size(); }
  std::span<const double> compliance() const { return compliance_; }
  void residual(std::span<double> rows) const;
  void program_residual(std::span<double> rows) const;
  /// What a part of the room between targets and the bound is for each row.
  void program_tolerance(double part_of_room, std::span<double> tolerance) const;
  /// Of increments of mu: a row pulls in or pushes out, never the other way.
  void program_bounds(std::span<double> lower, std::span<double> upper) const;
  void factor(std::span<const double> metric);
  void precondition(std::span<const double> r, std::span<double> s) const;
  /// field -= J^T z on owned vertices. Collective over neighbours.
  void spread(std::span<const double> z, std::span<Vec3> field);
  void subtract_difference(std::span<const Vec3> u, std::span<double> rows) const;
  /// mu += d_mu, for `displacement`: W J^T d_mu at an owned vertex. Collective over neighbours.
  void add(std::span<const double> d_mu);
  Vec3 displacement(Local vertex) const;

private:
  /// Of an owned triangle along warp or weft.
  struct Direction {
    TangentStencil stencil;
    double scale;  ///< s, m
    double mu = 0; ///< of the step so far
  };
  struct Row {
    Direction* of;
    Vec3 gradient; ///< 2 s w, times c the derivative by a vertex
    double length; ///< |w|
    double target; ///< t
    double side;   ///< 1 if it is stretched, -1 if pressed
  };
  double most() const;
  double side(const Direction& direction, double length) const;
  void pull(std::span<const double> z);

  const Cloth& cloth_;
  double bound_; ///< b
  std::vector<Direction> directions_;
  std::span<const Vec3> start_; ///< of the step, m
  std::span<const double> inverse_mass_;
  const Freedom* freedom_ = nullptr;
  bool any_ = false;
  double strain_kept_ = 0;
  std::vector<Row> rows_;
  std::vector<double> compliance_, diagonal_; ///< of rows
  std::vector<Vec3> pull_, change_;           ///< J^T z, of local vertices; J^T d_mu
};

} // namespace taut
