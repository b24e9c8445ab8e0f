#pragma once
#include "partition/edge_colours.hpp"
#include "src/state/cloth.hpp"
#include "src/state/freedom.hpp"

namespace taut {

/// Corrections of one edge at a time, or of each for itself, towards rest length [Provot 1995; Mueller et al.
/// 2007; with a compliance Macklin, Mueller, Chentanez 2016]: for an edge with ends a and b, d = x_b - x_a, n
/// = d/|d|,
///
///     ds = (|d| - l - a s) / (w_a + w_b + a),   x_a <- x_a + w_a ds n,   x_b <- x_b - w_b ds n,   s <- s +
///     ds,
///
/// where w are inverse masses, of a vertex that may move in some directions only w S_i n in place of w n and
/// w n^T S_i n in place of w, a = l c/h^2 with the compliance c, the strain of an edge per newton, and s =
/// h^2 T gives the tension T. Every rank corrects the edges around its own vertices: those cut by the
/// partition are corrected on both sides, to the same last bit.
class EdgeSweeps {
public:
  /// `cloth` must outlive the sweeps. Collective.
  explicit EdgeSweeps(const Cloth& cloth);

  /// For a step over `dt` in which vertices move only as `freedom` allows; `compliance` is c in 1/N. Not
  /// collective.
  void start(double dt, double compliance, const Freedom& freedom);

  /// One edge after the other, colour by colour: the order does not depend on the partition. `x` over local
  /// vertices; `s` over local edges, right at those with an end of this rank. Collective over neighbours,
  /// once a colour.
  void gauss_seidel(std::vector<Vec3>& x, std::vector<double>& s) const;

  /// All edges from the same x, by half of what each asks for: four can pull at a vertex. Collective over
  /// neighbours.
  void jacobi(std::vector<Vec3>& x, std::vector<double>& s);

  const EdgeColours& colours() const { return colours_; }

private:
  struct Correction {
    double ds;
    Vec3 normal;
  };
  /// W n = S_i n / m_i.
  Vec3 step(Local vertex, const Vec3& n) const { return inverse_mass_[vertex] * freedom_.allowed(vertex, n); }
  Correction correction(Local edge, std::span<const Vec3> x, double s) const;

  const Cloth& cloth_;
  EdgeColours colours_;
  Freedom freedom_;
  std::vector<double> inverse_mass_; ///< of local vertices, 0 if held
  double compliance_over_dt2_ = 0;
  std::vector<Correction> corrections_;
};

} // namespace taut
