#include "src/time/contact_balance.hpp"

#include <algorithm>

namespace taut {

namespace {

/// Measured where five sheets lie on each other: with a quarter of the contacts across two ranks a step takes
/// 2.2 times as long as with none. A vertex without contact is as much work as a quarter of a contact.
constexpr double cost_across = 4, work_of_vertex = 0.25;

constexpr int last_steps = 5;    ///< of the mean
constexpr Global at_least = 10;  ///< steps with a cut
constexpr double too_much = 0.4; ///< more waste than once

} // namespace

void ContactBalance::after_step(const State&, const StepRecord& record) {
  const StepCounts& c = record.counts;
  const double waste = (double(c.contacts_if_even - c.contacts) + cost_across * double(c.contacts_across)) /
                       (double(c.contacts) + work_of_vertex * double(vertices_));
  ++memory_.steps;
  memory_.waste += (waste - memory_.waste) / double(std::min<Global>(memory_.steps, last_steps));
  memory_.least = memory_.steps < last_steps ? memory_.waste : std::min(memory_.least, memory_.waste);
}

bool ContactBalance::wants_another_cut() const {
  return memory_.steps >= at_least && memory_.waste > memory_.least + too_much;
}

} // namespace taut
