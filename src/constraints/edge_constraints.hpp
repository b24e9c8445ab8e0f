#pragma once
#include "src/constraints/constraint_set.hpp"
#include "src/constraints/edge_loops.hpp"

#include <cmath>

namespace taut {

/// The constraints of all edges, C = |d|^2/l - l = 0 [G07 section 3], with their gradients: dC/dx = 2 d/l by
/// the second vertex of an edge, minus that by the first. What the methods that solve for tensions share.
///
/// Tensions are told by mu = h^2 lambda: the force density of an edge is q = 2 mu/(l h^2), in N/m. Each
/// constraint has a compliance c, the strain of an edge per newton of its tension, so that C = a mu with a =
/// 4 l c/h^2. Without it a thread pulled straight between two pins makes systems singular: what little it may
/// sag asks for a tension without bound. What it does is bounded, see ComplianceBounds.
class EdgeConstraints {
public:
  /// `cloth` must outlive the constraints; no compliance in `options` is none. Local edges whose entry of
  /// `constrained` is 0 have no constraint, in that no motion changes it; if it is empty, all have.
  EdgeConstraints(const Cloth& cloth, const config::Inextensibility& options,
                  const ComplianceBounds& bounds = {}, std::vector<char> constrained = {});

  /// For a step over `dt` in which vertices move only as `freedom` allows. Not collective.
  void start(double dt, const Freedom& freedom);

  /// Values and gradients at `x` (local vertices); returns the largest |strain| over all ranks, infinite if
  /// one is not a number. Collective.
  double evaluate(std::span<const Vec3> x);

  /// The same, but linearised at d + w d_start: w is what d misses of its length beyond half of it, and of
  /// its direction where it points back. Of an edge that collapsed or turned round d does not tell which way
  /// its ends have to go: linearised at d alone an impact on layers throws vertices as far as the cloth is
  /// wide. (With d_start in place of d impacts took a few iterations less, but folds, whose edges do turn,
  /// half as many again. Without contact this saves most of the rejected steps of folding cloth, but a
  /// correction has a torque then, and flags lost steps.) Collective.
  double evaluate(std::span<const Vec3> x, std::span<const Vec3> start);

  /// The same strain alone. Collective.
  double strain(std::span<const Vec3> x) const;

  /// C less what edges yield to mu (a mu, see Yield), of owned edges; 0 of those that no motion changes, as
  /// between two held vertices. Not collective.
  void residual(std::span<const double> mu, std::span<double> c) const;

  /// Of J^T mu the part of a vertex in the directions in which it may move, for gradients that may be those
  /// of another place. Not collective.
  Vec3 pull(Local vertex, std::span<const Vec3> gradients, std::span<const double> mu) const {
    return freedom_.allowed(vertex, sum_at(cloth_.mesh, vertex, gradients, mu));
  }

  /// mu from force densities, 0 of edges without constraint, and back; over local edges. Not collective.
  void to_mu(std::span<const double> force_density, std::span<double> mu) const;
  void to_force_density(std::span<const double> mu, std::span<double> force_density) const;

  const Cloth& cloth() const { return cloth_; }
  std::span<const double> lengths() const { return lengths_; } ///< m, of owned edges along their gradients
  const std::vector<Vec3>& gradients() const { return gradients_; }                ///< of local edges
  std::span<const double> scaled_compliance() const { return scaled_compliance_; } ///< a, of owned edges
  std::span<const double> inverse_mass() const { return inverse_mass_; } ///< of local vertices, 0 if held
  const Freedom& freedom() const { return freedom_; }

  /// Of an owned edge.
  Yield yield_to(double mu, Local edge) const {
    return yield(scaled_compliance_[edge], mu, 2 * cloth_.rest_length[edge] * bounds_.strain);
  }

  /// Whether any motion that is free changes the value of an edge. Not collective.
  bool can_change(Local edge) const;

  bool has(Local edge) const { return constrained_.empty() || constrained_[edge] != 0; }

private:
  template<class At>
  double linearize_all(std::span<const Vec3> x, const At& at);
  double linearize(Local edge, const Vec3& d, const Vec3& at);

  const Cloth& cloth_;
  std::vector<char> constrained_;
  double compliance_; ///< c, in 1/N
  ComplianceBounds bounds_;
  double dt_ = 0;
  Freedom freedom_;
  std::vector<Vec3> gradients_;
  std::vector<double> values_, lengths_, scaled_compliance_, inverse_mass_;
};

} // namespace taut
