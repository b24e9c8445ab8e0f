#pragma once
#include "src/time/stepper.hpp"
#include "src/time/stepper_parts.hpp"

namespace taut {

/// The stepper a case asks for. Throws InputError for what it cannot do with this mesh. Collective.
std::unique_ptr<Stepper> make_stepper(const StepperParts& parts, const Case& input);

} // namespace taut
