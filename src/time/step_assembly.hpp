#pragma once
#include "src/forces/force.hpp"
#include "src/time/integrator.hpp"
#include "src/time/stepper_parts.hpp"

#include <optional>

namespace taut {

/// The linearised equations of motion of an implicit-Euler step, A v' = b [BW98 eq. 6]. BDF2 is made of such
/// steps too: see Integrator.
///
/// With IMEX (implicit-explicit) only what the cloth does to itself is implicit: bending, shear, damping,
/// tension, all that is stiff. Loads, such as gravity and air drag, are those of the step's start, and leave
/// no trace in the matrix. Drag then limits the step to about twice the mass over the drag coefficient of a
/// vertex.
class StepAssembly {
public:
  /// All references must outlive the assembly. Not collective.
  StepAssembly(const Cloth& cloth, const Pattern& pattern, const Forces& forces,
               config::Integrator integrator);

  /// Asks all forces, in their order: collective if one of them is.
  void assemble(const StepStart& start);

  const StepSystem& system() const { return system_; }
  StepSystem& system() { return system_; }

private:
  void add_forces(const StepStart& start);
  void add_explicit_loads(const State& start, double dt);

  const Cloth& cloth_;
  const Forces& forces_;
  StepSystem system_;
  std::vector<Vec3> alteration_;    ///< from where forces are linearised to where the step starts
  std::optional<StepSystem> loads_; ///< of IMEX
  std::vector<Vec3> load_impulse_;
};

} // namespace taut
