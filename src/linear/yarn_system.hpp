#pragma once
#include "src/linear/yarn_factor.hpp"
#include "src/state/freedom.hpp"

namespace taut {

/// The part along yarns of J W J^T + diag(a): tridiagonal blocks, factored exactly across ranks. What
/// ProjectionSystem has inside its matrix, by itself.
class YarnSystem {
public:
  /// `mesh` must outlive the system. Collective.
  explicit YarnSystem(const DistributedMesh& mesh);

  /// As ProjectionSystem::assemble. Collective over neighbours.
  void factor(std::span<const Vec3> gradient, std::span<const double> inverse_mass, const Freedom& freedom,
              std::span<const double> scaled_compliance);

  /// x = T^-1 b over owned edges; both may be the same. Collective over neighbours.
  void solve(std::span<const double> b, std::span<double> x) const { factor_.solve(b, x); }

private:
  const DistributedMesh& mesh_;
  Yarns yarns_;
  YarnTridiagonal matrix_;
  YarnFactor factor_;
};

} // namespace taut
