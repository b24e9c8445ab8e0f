#include "src/time/untangle.hpp"

#include "src/contact/intersections.hpp"
#include "src/contact/untangler.hpp"
#include "src/filters/project.hpp"

#include <algorithm>

namespace taut {

namespace {

constexpr double strain_left = 0.5; ///< of the limit, by a projection

/// Keeps the lengths of edges where there is a limit for them.
class EdgeKeeper {
public:
  EdgeKeeper(const Simulation& simulation, const Case& input, const Freedom& freedom) {
    const auto& limits = simulation.inextensibility();
    if (!simulation.strain_limit() || limits.constrain != config::Constrain::edges) return;
    std::vector<double> masses = simulation.cloth().mass;
    for (Local i = 0; i < Local(masses.size()); ++i)
      if (!freedom.is_free(i)) masses[i] = held;
    projector_.emplace(simulation.cloth().mesh, masses,
                       ProjectOptions{.strain = strain_left * limits.strain,
                                      .compliance = limits.compliance.value_or(0.0),
                                      .dt = input.time.max_step});
  }

  bool keeps() const { return projector_.has_value(); }

  /// What cannot be projected stays as it is.
  void keep(std::vector<Vec3>& positions) {
    if (!projector_) return;
    try {
      positions = projector_->project(positions);
    } catch (const ProjectionError&) { // on all ranks alike; the strain that is left will tell
    }
  }

private:
  std::optional<Projector> projector_;
};

Freedom freedom_at_start(const Simulation& simulation, double dt) {
  Freedom freedom(simulation.state().positions.size());
  auto velocities = simulation.state().velocities;
  simulation.pins().prescribe(simulation.state(), dt, freedom, velocities);
  return freedom;
}

} // namespace

Untangled untangle(const Simulation& simulation, const Case& input,
                   const std::function<void(const Untangled&)>& after_round) {
  const Cloth& cloth = simulation.cloth();
  const Obstacles& obstacles = simulation.obstacles();
  Untangled result{.state = simulation.state()};
  std::vector<Vec3>& x = result.state.positions;
  std::vector<Vec3> bodies;
  obstacles.place(result.state.time, bodies);
  const Thickness thickness(cloth, input);
  Untangler untangler(cloth, obstacles, thickness);
  Intersections test(cloth, obstacles);
  const Freedom freedom = freedom_at_start(simulation, input.time.max_step);
  EdgeKeeper edges(simulation, input, freedom);
  // Of averages there is no keeper: those are relaxed, as of any start.
  const std::optional<double> most_strain =
      edges.keeps() ? simulation.strain_limit() : std::optional(simulation.most_strain_of_start());
  const auto measure = [&] {
    result.left = sum_over(cloth.mesh.comm, Global(test.find(x, bodies).size()));
    result.strain = simulation.gauge().measure(x).max;
    result.is_within_limit = !most_strain || result.strain <= *most_strain;
  };
  measure();
  if (result.left == 0) return Untangled{.state = simulation.state()};
  while (!result.succeeded() && result.rounds < most_untangling_rounds) {
    if (result.left > 0) {
      const std::vector<Vec3> moves = untangler.find(x, bodies);
      for (Local i = 0; i < cloth.mesh.vertices.owned; ++i)
        if (freedom.is_free(i)) x[i] += moves[i];
      cloth.mesh.vertex_halo.update(x);
    }
    edges.keep(x);
    ++result.rounds;
    measure();
    if (after_round) after_round(result);
  }
  for (Local i = 0; i < cloth.mesh.vertices.owned; ++i)
    result.farthest = std::max(result.farthest, (x[i] - simulation.state().positions[i]).norm());
  result.farthest = max_over(cloth.mesh.comm, result.farthest);
  return result;
}

} // namespace taut
