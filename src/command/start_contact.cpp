#include "src/command/start_contact.hpp"

#include "src/output/intersection_check.hpp"
#include "src/time/untangle.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <utility>

namespace taut::command {

namespace {

constexpr int rounds_told = 5; ///< between two lines of progress

/// What the rounds came to.
std::string describe(const Untangled& u) {
  return fmt::format("after {} rounds, in which no vertex went farther than {:.3g} m", u.rounds, u.farthest);
}

bool untangle_start(Simulation& simulation, const Case& input, const std::filesystem::path& file) {
  const bool speaks = rank_of(simulation.cloth().mesh.comm) == 0;
  const auto tell = [&](const Untangled& so_far) {
    if (!speaks || so_far.rounds % rounds_told != 0) return;
    const std::string left = so_far.left > 0 ? fmt::format("{} intersections left", so_far.left)
                                             : fmt::format("strained by {:.3g} %", 100 * so_far.strain);
    fmt::print("{}: untangling the start: {} after {} rounds of at most {}\n", input.name, left,
               so_far.rounds, most_untangling_rounds);
    std::fflush(stdout);
  };
  Untangled untangled = untangle(simulation, input, tell);
  if (!untangled.succeeded()) {
    IntersectionCheck check(simulation.cloth(), simulation.obstacles(), input);
    const bool still = check.finds_in(untangled.state, file);
    const std::string what =
        still ? fmt::format("{} intersections are left, the first: {}; they are in {}, for ParaView",
                            untangled.left, check.first(), file.string())
              : fmt::format("nothing intersects, but edges are strained by {:.3g}, over the limit",
                            untangled.strain);
    if (speaks)
      fmt::print(
          stderr,
          "taut: {}: contact.start: the start could not be untangled {}: {}; only shallow "
          "intersections can be: move `start` of the cloth or the obstacle, or repair the start shape\n",
          input.file.string(), describe(untangled), what);
    return false;
  }
  if (untangled.rounds == 0) return true;
  if (speaks)
    fmt::print("{}: the start intersected, and was untangled {}\n", input.name, describe(untangled));
  simulation.set_start(std::move(untangled.state));
  return true;
}

/// In steps of Fast Projection, whatever the method of the case. Where corners are strained by twenty limits
/// Newton's method overshoots, in short steps too, in which a projection hardly moves the rest.
Relaxed relax(Simulation& simulation, const Case& input) {
  if (input.inextensibility.method != config::InextensibilityMethod::newton ||
      simulation.strain_over_limit() <= 1)
    return simulation.relax();
  Case by_projection = input;
  by_projection.inextensibility.method = config::InextensibilityMethod::fast_projection;
  by_projection.inextensibility.solver.reset(); // Newton's: no other method factors triangles beside quads
  Simulation projecting(simulation.cloth().mesh.comm, by_projection);
  State start = projecting.state(), end = simulation.state();
  start.positions = end.positions;
  projecting.set_start(std::move(start));
  const Relaxed relaxed = projecting.relax();
  end.positions = projecting.state().positions;
  simulation.set_start(std::move(end));
  return relaxed;
}

bool relax_start(Simulation& simulation, const Case& input) {
  const Relaxed relaxed = relax(simulation, input);
  const bool speaks = rank_of(simulation.cloth().mesh.comm) == 0;
  if (relaxed.steps > 0 && relaxed.succeeded() && speaks)
    fmt::print("{}: the start was strained by {:.3g} times its limit; {} step{} relaxed it\n", input.name,
               relaxed.strain_before, relaxed.steps, relaxed.steps == 1 ? "" : "s");
  if (!relaxed.succeeded() && speaks)
    fmt::print(
        stderr,
        "taut: {}: the start is strained by {:.3g} times its limit, and could not be relaxed ({:.3g} "
        "times after {} steps); starts are within a strain of {:g}: bring the start shape nearer to the "
        "rest shape, or correct cloth.rest, cloth.scale or cloth.texture_unit\n",
        input.file.string(), relaxed.strain_before, relaxed.strain, relaxed.steps,
        simulation.most_strain_of_start());
  return relaxed.succeeded();
}

} // namespace

bool clear_start(Simulation& simulation, const Case& input, const std::filesystem::path& file) {
  if (!input.has_contact()) return true;
  if (input.contact.value_or(config::Contact{}).start == config::StartContact::untangle)
    return untangle_start(simulation, input, file);
  IntersectionCheck(simulation.cloth(), simulation.obstacles(), input).refuse(simulation.state(), file);
  return true;
}

bool prepare_start(Simulation& simulation, const Case& input, const std::filesystem::path& file) {
  return clear_start(simulation, input, file) && relax_start(simulation, input);
}

} // namespace taut::command
