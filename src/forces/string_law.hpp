#pragma once
#include "src/linear/step_system.hpp"

#include <algorithm>

namespace taut {

/// A string that never pulls with more than `force`. What it is too long by, e, costs
///
///     E = k/2 e^2 up to e = F/k, from there on F e - F^2/(2k)   [Huber 1964].
///
/// With w = min(k, F/e) the force is w e along the string. In place of its derivative along it, which is 0
/// where the pull is largest, systems get w: the parabola that touches E and is nowhere below it, as in
/// iteratively reweighted least squares, with which a step of any length takes ends together and not past
/// each other.
struct StringLaw {
  double force;     ///< N, at most
  double stiffness; ///< N/m

  double energy(double e) const {
    if (e <= 0) return 0;
    return stiffness * e <= force ? 0.5 * stiffness * e * e : force * e - 0.5 * force * force / stiffness;
  }
  double weight(double e) const { return std::min(stiffness, force / e); } ///< N/m, of e > 0
};

/// Adds a string along `d` (m, from its first end to its last) that is `e` > 0 too long. Of two ends, or of
/// one, whose other is not of the cloth. Not collective.
template<std::size_t n>
void add_string(StepSystem& system, const StringLaw& law, const std::array<Local, n>& ends,
                const Pattern::Slots<n>& slots, const Vec3& d, double e) {
  static_assert(n == 1 || n == 2);
  const double length = d.norm(), w = law.weight(e), across = std::min(w, w * e / length);
  const Vec3 direction = d / length;
  std::array<double, n> signs{1};
  if constexpr (n == 2) signs = {-1, 1};
  std::array<Local, 4> vertices;
  vertices.fill(ends[0]);
  std::array<Vec3, 4> gradient;
  gradient.fill(Vec3::Zero());
  for (std::size_t k = 0; k < n; ++k) {
    system.add_force(ends[k], (k == 0 ? across : -across) * d);
    vertices[k] = ends[k];
    gradient[k] = signs[k] * direction;
  }
  system.add_outer<n>(ends, slots, signs, across, 0.0);
  system.add_rank_one(vertices, gradient, w - across, 0.0);
}

} // namespace taut
