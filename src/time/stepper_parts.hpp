#pragma once
#include "src/contact/obstacles.hpp"
#include "src/forces/force.hpp"
#include "src/linear/pattern.hpp"
#include "src/state/pins.hpp"
#include "src/state/resolve.hpp"

#include <memory>

namespace taut {

using Forces = std::vector<std::unique_ptr<Force>>;

/// What steppers are made of. All that is referred to must outlive them, but not this struct.
struct StepperParts {
  const Cloth& cloth;
  const Obstacles& obstacles;
  const Pattern& pattern;
  const Pins& pins;
  const Resolved& resolved;
  std::span<const Vec3> start; ///< m, of local vertices, where the case puts them: while steppers are made
  Forces& forces;              ///< to which a stepper may add its own
};

} // namespace taut
