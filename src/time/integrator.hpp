#pragma once
#include "src/state/state.hpp"

namespace taut {

/// A step as implicit Euler sees it: from `state`, over `dt` seconds, x' = x + dt v'. Forces are
/// linearised at `linearized_at`.
struct StepStart {
  const State& state;
  double dt;
  const State& linearized_at;
};

/// The positions to which the velocities of the candidate lead from the start of the step.
void set_positions(const StepStart& start, Candidate& candidate);

/// What a step starts from. With implicit Euler and IMEX, the present state.
///
/// BDF2, with the ratio r of the step h to the one before,
///
///     x' = x^ + k v',  v' = v^ + k f(x', v') / m,   k = (1 + r)/(1 + 2r) h,
///     x^ = ((1 + r)^2 x^n - r^2 x^(n-1)) / (1 + 2r),  v^ alike,
///
/// is a step of implicit Euler over k from (x^, v^): all that makes an Euler step makes one of BDF2. For
/// equal steps k = 2h/3 and x^ = (4 x^n - x^(n-1))/3, the projected form of English and Bridson 2008. The
/// first step, and one that is longer than the one before by more than 1 + sqrt 2, beyond which BDF2 is
/// unstable, is one of implicit Euler.
///
/// Forces are linearised once a step, and with less than their whole derivative (its indefinite parts are
/// left out, the normals of drag are kept): at a distance O(h) from the end of the step that would cost BDF2
/// its second order. So with BDF2 they are linearised at x^n + r (x^n - x^(n-1)), v alike, which is O(h^2)
/// from it.
class Integrator {
public:
  explicit Integrator(config::Integrator kind) : kind_(kind) {}

  /// Of a step over `dt` seconds. Valid until the next call, or until `state` changes. Not collective.
  StepStart start(const State& state, double dt);

  /// Before `state` is replaced by that `dt` seconds later. Not collective.
  void store_history(State& state, double dt) const;

private:
  config::Integrator kind_;
  State bdf_base_, linearization_point_;
};

} // namespace taut
