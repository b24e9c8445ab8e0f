#pragma once
#include "src/contact/seam_strings.hpp"
#include "src/filters/contact_projection.hpp"
#include "src/time/stepper_parts.hpp"

namespace taut {

/// Contact as constraints, for a case that has it. Collective.
template<ConstraintSet Set>
std::unique_ptr<ContactProjection<Set>> make_contact_projection(const StepperParts& parts,
                                                                const Case& input) {
  return std::make_unique<ContactProjection<Set>>(
      parts.cloth, parts.obstacles, Thickness(parts.cloth, input),
      ContactProjectionOptions{.limits = parts.resolved.inextensibility,
                               .contact = input.contact.value_or(config::Contact{}),
                               .gravity = input.gravity.largest(),
                               .longest_step = input.time.max_step,
                               .strings = strings_clear_of(parts.obstacles, parts.cloth, parts.start)});
}

} // namespace taut
