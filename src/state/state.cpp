#include "src/state/state.hpp"

namespace taut {

namespace {

template<class T>
void zero(std::vector<T>& field, std::size_t size) {
  if constexpr (std::is_same_v<T, double>)
    field.assign(size, 0.0);
  else
    field.assign(size, T(T::Zero()));
}

} // namespace

void Candidate::reset_for(const State& state) {
  end_velocities.clear();
  zero(multipliers.force_density, state.multipliers.force_density.size());
  zero(multipliers.stress, state.multipliers.stress.size());
  zero(multipliers.projection_tension, state.multipliers.projection_tension.size());
  zero(multipliers.carried_contact_force, state.multipliers.carried_contact_force.size());
  multipliers.contacts.clear();
  reported.reaction.resize(state.reported.reaction.size());
  zero(reported.contact_force, state.reported.contact_force.size());
}

} // namespace taut
