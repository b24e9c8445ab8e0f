#pragma once
#include "partition/types.hpp"

#include <array>
#include <optional>
#include <span>
#include <vector>

namespace taut::garment {

/// The mesh of a panel in its plane. A triangle has -1 for its fourth corner.
struct PanelMesh {
  std::vector<Vec2> points;              ///< m; those of the outline first, in its order
  std::vector<std::array<int, 4>> cells; ///< counter-clockwise; quads first
};

/// Fills a panel: squares of the lattice (i h, j h), h = `spacing`, where they keep clear of the outline, and
/// triangles between them and the outline, whose points stay. `outline` is a simple polygon,
/// counter-clockwise, its axes along weft and warp, m. A function of its arguments alone: panels can be
/// meshed anywhere, in any order. Nothing if the polygon is not simple.
std::optional<PanelMesh> mesh_panel(std::span<const Vec2> outline, double spacing);

} // namespace taut::garment
