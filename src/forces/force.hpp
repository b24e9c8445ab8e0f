#pragma once
#include "src/linear/step_system.hpp"
#include "src/state/per_piece.hpp"
#include "src/state/state.hpp"

#include <string_view>

namespace taut {

/// Something that pushes on the cloth. A force sees one rank's part; only one that looks for contacts
/// communicates, so all ranks ask all forces in the same order.
class Force {
public:
  virtual ~Force() = default;

  virtual std::string_view name() const = 0;

  /// Whether the integrator `imex` takes it implicitly: true of what the cloth does to itself.
  virtual bool is_internal() const { return true; }

  /// Potential energy in J of this rank's share; the sum over ranks counts everything once. 0 for a force
  /// without one.
  virtual double energy(const State& state) const = 0;

  /// Adds the force at the state's positions and its stiffness and damping, as StepSystem asks for them. The
  /// stiffness is positive semi-definite: terms of the exact Hessian that are not are left out, and named by
  /// the force.
  virtual void add_to(StepSystem& system, const State& state) = 0;
};

} // namespace taut
