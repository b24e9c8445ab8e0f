#include "src/time/filter_chain.hpp"

#include "partition/traffic.hpp"
#include "src/config/methods.hpp"
#include "src/constraints/choose_set.hpp"
#include "src/filters/impulse_contact.hpp"
#include "src/filters/make_filter.hpp"
#include "src/forces/carried_tension.hpp"
#include "src/time/make_contact_projection.hpp"

#include <algorithm>

namespace taut {

namespace {

using FilterPointer = std::unique_ptr<VelocityFilter>;

FilterPointer make_contact_filter(const StepperParts& parts, const Case& input) {
  return for_chosen_set(
      parts.cloth, parts.resolved.inextensibility,
      [&]<ConstraintSet Set>() -> FilterPointer { return make_contact_projection<Set>(parts, input); });
}

std::vector<FilterPointer> make_filters(const StepperParts& parts, const Case& input) {
  std::vector<FilterPointer> filters;
  if (input.contact_model() == config::ContactModel::constraint) {
    filters.push_back(make_contact_filter(parts, input));
    return filters;
  }
  if (auto filter = make_filter(parts.cloth, parts.pattern, parts.resolved.inextensibility))
    filters.push_back(std::move(filter));
  if (input.contact_model() == config::ContactModel::impulse)
    filters.insert(config::contact_is_last(input) ? filters.end() : filters.begin(),
                   std::make_unique<ImpulseContact>(parts.cloth, parts.obstacles, input));
  return filters;
}

/// Where averages around vertices are kept, and the next step carries their tension. Not with contact: what
/// presses is found in the metric of the masses, and tension that runs ahead of it set a disc of 1319
/// vertices on a ball astir, 2e-5 J in place of 6e-7 after 3 s (with a tenth of today's stretch stiffness).
bool hands_stretch_over(const config::Inextensibility& limits, const Case& input) {
  return *limits.constrain == config::Constrain::vertices && config::is_filter(limits.method) &&
         limits.carried_tension && input.contact_model() != config::ContactModel::constraint;
}

bool all_finite(MPI_Comm comm, std::span<const Vec3> field) {
  return !any_of(comm, std::any_of(field.begin(), field.end(), [](const Vec3& v) { return !v.allFinite(); }));
}

} // namespace

FilterChain::FilterChain(const StepperParts& parts, const Case& input)
    : cloth_(parts.cloth), limits_(parts.resolved.inextensibility), holds_limit_(config::holds_limit(input)),
      contact_is_filter_(input.contact_model() == config::ContactModel::constraint ||
                         input.contact_model() == config::ContactModel::impulse),
      pushes_(edges_with_pushes(parts.cloth.mesh, *limits_.constrain)), filters_(make_filters(parts, input)) {
  if (hands_stretch_over(limits_, input)) stretch_.emplace(parts.cloth, parts.resolved);
}

void FilterChain::carry_tension(const State& state, Candidate& candidate) const {
  const std::vector<double>& before = state.multipliers.force_density;
  for (std::size_t e = 0; e < before.size(); ++e) candidate.multipliers.force_density[e] = carried(state, e);
}

void FilterChain::apply(const StepStart& start, const Freedom& freedom, Candidate& candidate,
                        StepReport& report) {
  if (stretch_) {
    set_positions(start, candidate);
    stretch_->start(candidate.positions);
  }
  apply_filters(start, freedom, candidate, report);
  set_positions(start, candidate);
  if (config::is_filter(limits_.method)) add_pull(start.state, freedom, candidate);
  if (contact_is_filter_) add_pressure(start.state, freedom, candidate);
  if (stretch_) stretch_->add_to(candidate);
}

void FilterChain::apply_filters(const StepStart& start, const Freedom& freedom, Candidate& candidate,
                                StepReport& report) {
  const PhaseScope phase(Phase::projection);
  for (std::size_t k = 0; k < filters_.size() && report.failure.empty(); ++k) {
    const FilterReport filtered = filters_[k]->apply(start.state, start.dt, freedom, candidate);
    report += filtered;
    report.too_costly = report.too_costly || filtered.too_costly;
    // where contact has the last word and breaks the limit, the projection only does what it can
    const bool has_last_word = k + 1 == filters_.size();
    if (holds_limit_ || has_last_word || !all_finite(cloth_.mesh.comm, candidate.velocities))
      report.failure = filtered.failure;
  }
}

/// Prescribed velocities are kept by the prediction, which knows the tension carried into the step, and
/// against what filters add to it: from what prescribing them took, to what it took at the end of the step.
void FilterChain::add_pull(const State& state, const Freedom& freedom, Candidate& candidate) const {
  if (freedom.all_free()) return;
  for (Local i = 0; i < cloth_.mesh.vertices.owned; ++i) {
    if (freedom.is_free(i)) continue;
    Vec3 pull = Vec3::Zero();
    for (const EdgeEnd& end : cloth_.mesh.star_of(i))
      pull += (candidate.multipliers.force_density[end.edge] - carried(state, std::size_t(end.edge))) *
              (candidate.positions[end.other] - candidate.positions[i]);
    candidate.reported.reaction[i] -= freedom.denied(i, pull);
  }
}

/// They are kept against what contacts press as well, beyond what the prediction carried of it.
void FilterChain::add_pressure(const State& state, const Freedom& freedom, Candidate& candidate) const {
  const std::vector<Vec3>& pressed = candidate.reported.contact_force;
  for (Local i = 0; i < Local(pressed.size()); ++i)
    if (!freedom.is_free(i))
      candidate.reported.reaction[i] -=
          freedom.denied(i, pressed[i] - state.multipliers.carried_contact_force[i]);
}

/// What the prediction carries of a force density of the step before.
double FilterChain::carried(const State& state, std::size_t edge) const {
  if (!limits_.carried_tension) return 0.0;
  const double q = state.multipliers.force_density[edge];
  return pushes_[edge] ? q : std::max(q, 0.0);
}

} // namespace taut
