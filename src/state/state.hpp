#pragma once
#include "src/state/cloth.hpp"
#include "src/state/contact_memory.hpp"

/// What changes: fields over [owned | ghosts], ghosts current, or over owned vertices alone. Fields that a
/// case has no use for are empty. A state and the candidate for the next one hold the same groups of them.
namespace taut {

/// What the next step starts from: forces and stresses rather than multipliers times a step squared, because
/// the next step may be of another size.
struct Multipliers {
  std::vector<double> force_density{}; ///< N/m, of local edges: the tension of an edge over its length
  std::vector<Vec2> stress{}; ///< N/m, of local vertices: along warp and weft, see MetricSet; with these
  std::vector<double>
      projection_tension{}; ///< N, of local edges: by the projections of the last step; with contact
  std::vector<Vec3>
      carried_contact_force{}; ///< N, of local vertices: what of it lasted through the last step
  ContactMemory contacts{};    ///< of the last step, at their homes
};

/// What is only shown: nothing is computed from it.
struct Reported {
  std::vector<Vec3> reaction{};      ///< N, of owned vertices: with what their pin acts on them
  std::vector<Vec3> contact_force{}; ///< N, of owned vertices: what contacts press and rub
};

/// How far bodies are that grow, by the vertices of all obstacles; the same on all ranks.
struct BodyGrowth {
  std::vector<double> slimness{}; ///< 1: as slim as can be, 0: full
  std::vector<double> speed{};    ///< 1/s, of the slimness
};

struct State {
  double time = 0;                ///< s
  Global step = 0;                ///< accepted steps so far
  std::vector<Vec3> positions{};  ///< m, of local vertices
  std::vector<Vec3> velocities{}; ///< m/s
  Multipliers multipliers{};
  Reported reported{};
  BodyGrowth bodies{};
  double start_depth = 0; ///< m along gravity, of the lowest point at the start; only for reports

  /// The step before, for bdf2; empty where there was none, and for the other integrators.
  std::vector<Vec3> previous_positions{}, previous_velocities{};
  double previous_dt = 0; ///< s, from there to here; 0: the next step is one of implicit Euler
};

/// Visits every field of the state, with its name in a checkpoint: `visit.on_vertices(name, field)`,
/// `visit.on_edges(name, field)` and `visit.on_contacts(name, memory)`; those of which the case may have no
/// use as `visit.on_vertices_if_any` and `visit.on_edges_if_any`; what all ranks have alike as
/// `visit.on_all_if_any`. A new field of the state needs a line here
/// and one in its group, and nothing else.
template<class S, class V>
void visit_fields(S& state, V& visit) {
  auto& multipliers = state.multipliers;
  visit.on_vertices("positions", state.positions);
  visit.on_vertices("velocities", state.velocities);
  visit.on_vertices_if_any("contact_force", multipliers.carried_contact_force);
  visit.on_edges("force_density", multipliers.force_density);
  visit.on_vertices_if_any("stress", multipliers.stress);
  visit.on_edges_if_any("pulled", multipliers.projection_tension);
  visit.on_contacts("contacts", multipliers.contacts);
  visit.on_all_if_any("slimness", state.bodies.slimness);
  visit.on_all_if_any("slimness_speed", state.bodies.speed);
  if (state.previous_dt > 0) {
    visit.on_vertices("previous_positions", state.previous_positions);
    visit.on_vertices("previous_velocities", state.previous_velocities);
  }
}

/// What a step proposes before it is accepted.
struct Candidate {
  std::vector<Vec3> positions;        ///< m, at its end: made when all filters are done, and room until then
  std::vector<Vec3> velocities;       ///< those that lead from the start of the step to its end
  std::vector<Vec3> end_velocities{}; ///< those at the end, where they are others; else empty
  Multipliers multipliers;            ///< zero, and no contacts, unless a filter says otherwise
  Reported reported;

  /// Multipliers and reports as many as those of `state`, and zero.
  void reset_for(const State& state);
};

} // namespace taut
