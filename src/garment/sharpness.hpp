#pragma once
#include "src/garment/panel_mesh.hpp"

namespace taut::garment {

/// The sharpest triangle of some.
struct SharpPlace {
  double angle = 10;         ///< rad, its smallest; more than any, where there are none
  Vec2 place = Vec2::Zero(); ///< m, its centre
};

struct Sharpness {
  SharpPlace all;
  SharpPlace elsewhere; ///< not in a tip: a corner of the outline below 30 degrees, as far as it is thinner
                        ///< than an edge
};

/// Of the triangles of a panel; `corners` are the points of its outline at which edges of the pattern meet.
Sharpness sharpness_of(const PanelMesh& mesh, std::size_t outline_points, std::span<const int> corners,
                       double spacing);

} // namespace taut::garment
