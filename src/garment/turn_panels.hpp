#pragma once
#include "src/garment/sewn_mesh.hpp"

namespace taut::garment {

/// Turns the cells of panels round, with their texture, until all are oriented alike across seams: where one
/// edge is sewn to another with `right_wrong`, the right side of one panel goes on as the wrong side of the
/// other. Of panels that are sewn to one another the first stays as it is. Throws `InputError`, naming two
/// panels, where that cannot be, as of a Moebius strip.
void turn_panels(const GarmentMesh& mesh, const std::string& name, SewnMesh& sewn);

} // namespace taut::garment
