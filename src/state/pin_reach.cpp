#include "src/state/pin_reach.hpp"

#include "src/state/pins.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <queue>

namespace taut {

namespace {

/// m along edges from a vertex to those that this rank owns, within its part [Dijkstra 1959]: `reach` holds
/// what is known so far; true if some became nearer.
bool extend(const Cloth& cloth, std::span<double> reach) {
  const DistributedMesh& mesh = cloth.mesh;
  using Entry = std::pair<double, Local>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  const auto offer = [&](Local v, double way) {
    if (way >= reach[v]) return;
    reach[v] = way;
    open.emplace(way, v);
  };
  for (Local v = 0; v < mesh.vertices.owned; ++v)
    for (const EdgeEnd& end : mesh.star_of(v)) offer(v, reach[end.other] + cloth.rest_length[end.edge]);
  const bool is_nearer = !open.empty();
  while (!open.empty()) {
    const auto [way, v] = open.top();
    open.pop();
    if (way > reach[v]) continue;
    for (const EdgeEnd& end : mesh.star_of(v))
      if (mesh.owns_vertex(end.other)) offer(end.other, way + cloth.rest_length[end.edge]);
  }
  return is_nearer;
}

/// m along edges from a vertex to the local ones; infinite where nothing joins them. Collective.
std::vector<double> ways_from(const Cloth& cloth, Global from) {
  const IndexMap& map = cloth.mesh.vertices;
  std::vector<double> reach(map.size(), HUGE_VAL);
  for (Local i = 0; i < map.size(); ++i)
    if (map.original[i] == from) reach[i] = 0;
  while (any_of(cloth.mesh.comm, extend(cloth, reach))) cloth.mesh.vertex_halo.update(reach);
  return reach;
}

/// That of one vertex, on all ranks. Collective.
double way_to(const Cloth& cloth, Global vertex, std::span<const double> ways) {
  const IndexMap& map = cloth.mesh.vertices;
  double way = HUGE_VAL;
  for (Local i = 0; i < map.owned; ++i)
    if (map.original[i] == vertex) way = ways[i];
  return -max_over(cloth.mesh.comm, -way);
}

/// m between the places that their pins have for them.
double distance_at(const Case& input, const HeldVertex& a, const HeldVertex& b, double time) {
  const Vec3 one = place_at(input.pins[a.pin].motion, a.start, time),
             other = place_at(input.pins[b.pin].motion, b.start, time);
  return (one - other).norm();
}

/// The keyframes of two pins while both hold, in order.
std::vector<double> times_of(const Case& input, std::size_t one, std::size_t other) {
  std::vector<double> times;
  double last = input.time.end;
  for (const config::Pin& pin : {input.pins[one], input.pins[other]}) {
    last = std::min(last, pin.release.value_or(HUGE_VAL));
    for (const config::Keyframe& k : pin.motion) times.push_back(k.time);
  }
  std::erase_if(times, [&](double time) { return time > last; });
  std::sort(times.begin(), times.end());
  return times;
}

/// Whether they come farther apart than they start, where nothing is strained too far.
bool draw_apart(const Case& input, const HeldVertex& a, const HeldVertex& b) {
  const std::vector<double> times = times_of(input, a.pin, b.pin);
  return std::any_of(times.begin(), times.end(), [&](double time) {
    return distance_at(input, a, b, time) > (a.start - b.start).norm();
  });
}

/// `way`: m between them along edges.
void check_pair(const Case& input, const HeldVertex& a, const HeldVertex& b, double way) {
  const config::Inextensibility& limits = input.inextensibility;
  const double most = (1 + limits.strain * limits.faces) * way, at_start = (a.start - b.start).norm();
  for (const double time : times_of(input, a.pin, b.pin)) {
    const double apart = distance_at(input, a, b, time);
    if (apart <= std::max(most, at_start)) continue;
    throw InputError(fmt::format("{}: pins.{} and pins.{} bring vertices {} and {} to {:.4g} m from each "
                                 "other at {:g} s, {:.3g} m more than the cloth between them reaches at its "
                                 "limit of strain ({:.4g} m); move them less, or let one of them go",
                                 input.file.string(), a.pin, b.pin, a.vertex, b.vertex, apart, time,
                                 apart - most, most));
  }
}

} // namespace

void check_reach(const Cloth& cloth, const Case& input, std::span<const HeldVertex> held) {
  for (std::size_t i = 0; i < held.size(); ++i) {
    std::vector<HeldVertex> drawn;
    for (const HeldVertex& other : held.subspan(i + 1))
      if (other.pin != held[i].pin && draw_apart(input, held[i], other)) drawn.push_back(other);
    if (drawn.empty()) continue;
    const std::vector<double> ways = ways_from(cloth, held[i].vertex);
    for (const HeldVertex& other : drawn)
      check_pair(input, held[i], other, way_to(cloth, other.vertex, ways));
  }
}

} // namespace taut
