#pragma once
#include "partition/types.hpp"

#include <array>
#include <span>
#include <vector>

namespace taut::garment {

/// What of a square lattice lies well inside an outline.
struct Lattice {
  std::vector<Vec2> points;              ///< corners of the quads, row by row
  std::vector<std::array<int, 4>> quads; ///< counter-clockwise from the lower left corner, row by row
  std::vector<std::vector<int>> rings;   ///< around the quads: points, the quads on the left
  std::vector<Vec2> loose;               ///< points of the lattice as far inside that are no corner of a quad
};

/// The points (i h, j h) inside the simple polygon `outline`, closed, of any direction, that keep clear of
/// it, with the squares between them; h = `spacing`, m. Clear is 0.6 h from a side as long as h, so that a
/// band of triangles fits between, and up to 1.2 h from shorter ones, so that they can grow. No two quads
/// share just a corner.
Lattice lattice_in(std::span<const Vec2> outline, double spacing);

} // namespace taut::garment
