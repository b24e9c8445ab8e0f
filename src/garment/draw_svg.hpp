#pragma once
#include "src/garment/garment_mesh.hpp"

#include <string>

namespace taut::garment {

/// The panels as an SVG drawing, side by side, each as seen from its right side with warp upwards, 1:1: mesh,
/// outline, seams (the two sides of one in one colour, under its number), name and the direction of warp.
/// Above 300 000 cells the mesh is left out.
std::string draw_svg(const GarmentMesh& mesh);

} // namespace taut::garment
