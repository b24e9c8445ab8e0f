#pragma once
#include "src/state/cloth.hpp"
#include "src/state/freedom.hpp"

namespace taut {

/// The compliance c in 1/N that `options` ask for, of a cloth with this weight in N. By default it is such
/// that a taut thread which bears the whole weight W stretches by e = a tenth of the limit: it sags by s with
/// e = 8/3 (s/L)^2 and T = W L/(8 s), so c = e/T = 4.9 e^(3/2) / W.
double compliance_of(const config::Inextensibility& options, double weight);

/// The constraints of all edges, C = |d|^2/l - l = 0 [G07 section 3], with their gradients: dC/dx = 2 d/l by
/// the second vertex of an edge, minus that by the first. What the methods that solve for tensions share.
///
/// Tensions are told by mu = h^2 lambda: the force density of an edge is q = 2 mu/(l h^2), in N/m. Each
/// constraint has a compliance c, the strain of an edge per newton of its tension, so that C = a mu with a =
/// 4 l c/h^2. Without it a thread pulled straight between two pins makes systems singular: what little it may
/// sag asks for a tension without bound.
class EdgeConstraints {
public:
  /// `cloth` must outlive the constraints; `weight` is that of the whole cloth in N, for the default
  /// compliance.
  EdgeConstraints(const Cloth& cloth, const config::Inextensibility& options, double weight);

  /// For a step over `dt` in which vertices move only as `freedom` allows. Not collective.
  void start(double dt, const Freedom& freedom);

  /// Values and gradients at `x` (local vertices); returns the largest |strain| over all ranks, infinite if
  /// one is not a number. Collective.
  double evaluate(std::span<const Vec3> x);

  /// C - a mu of owned edges; 0 of those that no motion changes, as between two held vertices. Not
  /// collective.
  void residual(std::span<const double> mu, std::span<double> c) const;

  /// Of J^T mu the part of a vertex in the directions in which it may move, for gradients that may be those
  /// of another place. Not collective.
  Vec3 pull(Local vertex, std::span<const Vec3> gradients, std::span<const double> mu) const {
    Vec3 pull = Vec3::Zero();
    for (const EdgeEnd& end : cloth_.mesh.star_of(vertex))
      pull += end.sign * mu[end.edge] * gradients[end.edge];
    return freedom_.allowed(vertex, pull);
  }

  /// mu from force densities, and back; over local edges. Not collective.
  void to_mu(std::span<const double> force_density, std::span<double> mu) const;
  void to_force_density(std::span<const double> mu, std::span<double> force_density) const;

  const Cloth& cloth() const { return cloth_; }
  double compliance() const { return compliance_; }                                ///< c, in 1/N
  const std::vector<Vec3>& gradients() const { return gradients_; }                ///< of local edges
  std::span<const double> scaled_compliance() const { return scaled_compliance_; } ///< a, of owned edges
  std::span<const double> inverse_mass() const { return inverse_mass_; } ///< of local vertices, 0 if held
  const Freedom& freedom() const { return freedom_; }

private:
  bool can_change(Local edge) const;

  const Cloth& cloth_;
  double compliance_;
  double dt_ = 0;
  Freedom freedom_;
  std::vector<Vec3> gradients_;
  std::vector<double> values_, scaled_compliance_, inverse_mass_;
};

} // namespace taut
