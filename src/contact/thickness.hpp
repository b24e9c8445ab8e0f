#pragma once
#include "src/state/cloth.hpp"

namespace taut {

/// What contact keeps between midsurfaces, in m: `contact.thickness`, or a tenth of the mean edge. Throws
/// InputError if neighbours in the cloth would push each other apart. Collective.
double contact_thickness(const Cloth& cloth, const Case& input);

} // namespace taut
