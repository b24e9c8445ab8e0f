#pragma once
#include "src/contact/contact_search.hpp"

namespace taut {

/// Measures how near the cloth is to itself and to obstacles, by a search of its own: what the result shows,
/// whatever found its contacts.
class GapGauge {
public:
  /// Both must outlive it. Gaps beyond `reach` (m) are not looked for. Collective.
  GapGauge(const Cloth& cloth, const Obstacles& obstacles, double reach);

  /// The gap, in m, between the features around each owned vertex and the nearest other feature of the cloth
  /// or of a body, the radii of bodies taken off; `reach` where there is none so near. `cloth` over local
  /// vertices, ghosts current. Collective.
  std::vector<double> measure(std::span<const Vec3> cloth, std::span<const Vec3> obstacles);

private:
  ContactSearch search_;
  double reach_;
  std::vector<Vec3> field_;
};

} // namespace taut
