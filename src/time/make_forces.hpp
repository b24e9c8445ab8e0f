#pragma once
#include "src/contact/obstacles.hpp"
#include "src/state/resolve.hpp"
#include "src/time/implicit_euler.hpp"

namespace taut {

/// The forces a case asks for; `cloth`, `obstacles` and `pattern` must outlive them. Throws InputError,
/// naming key and model, for a model that cannot serve this mesh. Collective.
Forces make_forces(const Cloth& cloth, const Obstacles& obstacles, const Pattern& pattern, const Case& input,
                   const Resolved& resolved, std::span<const Vec3> start);

/// The names of the energies of a run, in order: forces of one name, each of its own pieces of cloth, have
/// one.
std::vector<std::string> energy_names(const Forces& forces);

} // namespace taut
