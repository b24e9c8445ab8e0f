#include "src/forces/seam_force.hpp"

#include <algorithm>
#include <cmath>

namespace taut {

namespace {

constexpr double mostly = 0.7; ///< of a string's length along y: from front to back

/// How far apart the ends of a closed seam may be at a time, over the length of seam at them.
double closed_at(double time, const config::Sewing& sewing) {
  const double late = 0.5 * (sewing.limit - sewing.time);
  const double part = late > 0 ? std::clamp((time - sewing.time) / late, 0.0, 1.0) : 0.0;
  return SeamForce::closed + part * (SeamForce::closed_late - SeamForce::closed);
}

/// The length of seam at a vertex, in the mean, m. Collective.
double mean_seam_length(const Cloth& cloth) {
  std::array<double, 2> sums{};
  for (const auto& [a, b] : cloth.mesh.seams)
    if (cloth.mesh.owns_vertex(a)) {
      sums[0] += seam_length_at(cloth, a);
      ++sums[1];
    }
  sum_in_place(cloth.mesh.comm, sums);
  return sums[0] / std::max(1.0, sums[1]);
}

} // namespace

SeamForce::SeamForce(const Cloth& cloth, const Pattern& pattern, const config::Sewing& sewing)
    : cloth_(cloth), time_(sewing.time) {
  const auto& rest = cloth.mesh.rest_positions;
  const double least = least_length * mean_seam_length(cloth);
  for (const auto& pair : cloth.mesh.seams) {
    const double share = std::max(seam_length_at(cloth, pair[0]), least), force = sewing.force * share;
    const Vec3 d = rest[pair[1]] - rest[pair[0]];
    strings_.push_back({pair,
                        d.norm(),
                        std::abs(d[1]) > mostly * d.norm(),
                        {force, force / (held * share)},
                        pattern.slots<2>(pair)});
  }
}

/// Of the length at the start 1 - 3 s^2 + 2 s^3, whose ends are at rest.
double SeamForce::length_at(const String& string, double time) const {
  constexpr double first_until = 0.6, others_from = 0.4; // of the time
  const double from = string.is_first ? 0 : others_from, until = string.is_first ? first_until : 1;
  const double s = std::clamp((time / time_ - from) / (until - from), 0.0, 1.0);
  return string.length * (1 - s * s * (3 - 2 * s));
}

double SeamForce::energy(const State& state) const {
  double energy = 0;
  for (const String& s : strings_) {
    if (!cloth_.mesh.owns_vertex(s.ends[0])) continue;
    const double distance = (state.positions[s.ends[1]] - state.positions[s.ends[0]]).norm();
    energy += s.law.energy(distance - length_at(s, state.time));
  }
  return energy;
}

void SeamForce::add_to(StepSystem& system, const State& state) {
  for (const String& s : strings_) {
    const auto& [a, b] = s.ends;
    const Vec3 d = state.positions[b] - state.positions[a];
    const double e = d.norm() - length_at(s, state.time + system.dt());
    if (e > 0) add_string<2>(system, s.law, s.ends, s.slots, d, e);
  }
}

OpenSeam widest_seam(const Cloth& cloth, const State& state, const config::Sewing& sewing) {
  const IndexMap& map = cloth.mesh.vertices;
  const std::span<const Vec3> positions = state.positions;
  const double closed = closed_at(state.time, sewing);
  const double least = SeamForce::least_length * mean_seam_length(cloth);
  OpenSeam widest;
  for (const auto& [a, b] : cloth.mesh.seams) {
    const double distance = (positions[b] - positions[a]).norm();
    const double length = std::max({seam_length_at(cloth, a), seam_length_at(cloth, b), least});
    const double over = distance / (closed * length);
    if (cloth.mesh.owns_vertex(a) && over > widest.over_closed)
      widest = {distance, over, map.original[a], map.original[b], 0.5 * (positions[a] + positions[b])};
  }
  for (const OpenSeam& seam : gather_to_all<OpenSeam>(cloth.mesh.comm, std::span(&widest, 1)))
    if (seam.over_closed > widest.over_closed) widest = seam;
  return widest;
}

} // namespace taut
