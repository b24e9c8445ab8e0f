#pragma once
#include "src/time/simulation.hpp"

#include <functional>

namespace taut {

/// Whatever is not untangled then will not be.
inline constexpr int most_untangling_rounds = 100;

/// What became of a start that intersects.
struct Untangled {
  State state;         ///< the start, its free vertices moved
  int rounds = 0;      ///< that it took; 0: nothing intersected, and the state is as it was
  double farthest = 0; ///< m that any vertex was moved
  Global left = 0;     ///< intersections
  double strain = 0;   ///< largest |strain|
  bool is_within_limit = true;

  bool succeeded() const { return left == 0 && is_within_limit; }
};

/// Moves the cloth of the start out of shallow intersections with itself and with obstacles, before the first
/// step: in rounds of a small way out (Untangler) and a projection that keeps the edges, until the exact test
/// finds no intersection and the strain is within the limit, or the rounds are used up. Velocities stay.
/// `after_round`, if given, sees the result so far, on all ranks alike. Collective.
Untangled untangle(const Simulation& simulation, const Case& input,
                   const std::function<void(const Untangled&)>& after_round = {});

} // namespace taut
