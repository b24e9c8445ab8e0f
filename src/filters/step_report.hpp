#pragma once
#include "partition/types.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace taut {

/// What a step, a part of it, or a run of many took. Seconds are on the clock, those of `cpu_seconds` of the
/// processors.
struct StepCounts {
  Global velocity_iterations = 0; ///< of the velocity's linear solver
  Global iterations = 0;          ///< of filters
  Global linear_iterations = 0;   ///< of the filters' linear solver, over all of `iterations`
  Global contacts = 0;            ///< features in reach of each other
  Global contacts_if_even = 0;    ///< if every rank had as many as the one with most
  Global contacts_across = 0;     ///< those of features on different ranks
  double smallest_gap = HUGE_VAL; ///< m, between what can collide; infinite: not in reach, or not looked for
  double velocity_seconds = 0;
  double projection_seconds = 0; ///< without `contact_seconds`
  double contact_seconds = 0;    ///< finding what can meet, and moving without meeting
  double cpu_seconds = 0;        ///< of all parts; waiting for other ranks counts

  /// The time of `other` alone, as of an attempt that was thrown away.
  void add_seconds_of(const StepCounts& other) {
    velocity_seconds += other.velocity_seconds;
    projection_seconds += other.projection_seconds;
    contact_seconds += other.contact_seconds;
    cpu_seconds += other.cpu_seconds;
  }
  StepCounts& operator+=(const StepCounts& other) {
    velocity_iterations += other.velocity_iterations;
    iterations += other.iterations;
    linear_iterations += other.linear_iterations;
    contacts += other.contacts;
    contacts_if_even += other.contacts_if_even;
    contacts_across += other.contacts_across;
    smallest_gap = std::min(smallest_gap, other.smallest_gap);
    add_seconds_of(other);
    return *this;
  }
  bool operator==(const StepCounts&) const = default;
};

/// What a step, or a filter in it, took and came to.
struct StepReport : StepCounts {
  double residual = 0; ///< what is left of the equations of motion, where they are measured: see NewtonStep
  bool too_costly = false; ///< two steps of half the length would have cost less, most likely
  std::string failure;     ///< empty, or why the step cannot be accepted
};

} // namespace taut
