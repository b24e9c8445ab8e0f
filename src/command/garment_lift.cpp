#include "src/command/garment_lift.hpp"

#include "src/contact/closest.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace taut::command {

namespace {

constexpr double pace = 0.01;          // m
constexpr int farthest = 20;           // paces
constexpr int clearance = 10;          // paces
constexpr std::size_t most_ways = 500; // of a cloth on a rank

using Way = std::array<Vec3, 2>;
using Corners = std::array<Vec3, 3>;

/// Some of those of cloth `k` that this rank owns, spread evenly.
std::vector<Way> ways_of(const Cloth& cloth, std::span<const Vec3> positions, std::size_t k) {
  std::vector<Way> ways;
  for (const auto& [a, b] : cloth.mesh.seams)
    if (cloth.mesh.owns_vertex(a) && cloth.piece_of(a) == k) ways.push_back({positions[a], positions[b]});
  const std::size_t stride = 1 + ways.size() / most_ways;
  std::vector<Way> some;
  for (std::size_t i = 0; i < ways.size(); i += stride) some.push_back(ways[i]);
  return some;
}

std::vector<Corners> triangles_of(const Obstacles& obstacles) {
  std::vector<Vec3> places;
  obstacles.place(0, places);
  std::vector<Corners> triangles;
  for (const Element& e : obstacles.elements())
    if (e.is_triangle())
      triangles.push_back({places[e.vertices[0]], places[e.vertices[1]], places[e.vertices[2]]});
  return triangles;
}

/// Whether it may at any lift: seen from above.
bool may_pass(const Way& way, const Corners& t) {
  for (int k = 0; k < 2; ++k) {
    const auto [low, high] = std::minmax({t[0][k], t[1][k], t[2][k]});
    const auto [from, to] = std::minmax(way[0][k], way[1][k]);
    if (to < low || from > high) return false;
  }
  return true;
}

/// For each number of paces, from -farthest - clearance on, how many ways pass a body.
std::vector<double> blocked_ways(const std::vector<Way>& ways, const std::vector<Corners>& triangles) {
  constexpr int reach = farthest + clearance;
  std::vector<double> blocked(2 * reach + 1, 0.0);
  for (const Way& way : ways) {
    std::vector<const Corners*> near;
    for (const Corners& t : triangles)
      if (may_pass(way, t)) near.push_back(&t);
    for (int k = -reach; k <= reach; ++k)
      blocked[k + reach] += std::any_of(near.begin(), near.end(), [&](const Corners* t) {
        const Vec3 lift = k * pace * Vec3::UnitZ();
        return passes(way[0] + lift, way[1] + lift, *t);
      });
  }
  return blocked;
}

/// How near ways are to bodies after so many paces: those that pass at places up to the clearance away.
double cost_at(const std::vector<double>& blocked, int paces) {
  double cost = 0;
  for (int j = -clearance; j <= clearance; ++j)
    cost += (1 - std::abs(j) / (clearance + 1.0)) * blocked[paces + j + farthest + clearance];
  return cost;
}

/// The nearest of those places at which ways are hardly nearer to a body than at the best. What lies beyond a
/// place that is worse than the start does not count: above its shoulders a shirt passes no arm either.
double best_lift(const std::vector<double>& blocked) {
  const double hardly = 0.03 * *std::max_element(blocked.begin(), blocked.end());
  const double start = cost_at(blocked, 0);
  const auto is_on_the_way = [&](int paces) {
    return std::abs(paces) <= farthest && cost_at(blocked, paces) <= start + hardly;
  };
  int lowest = 0, highest = 0;
  while (is_on_the_way(lowest - 1)) --lowest;
  while (is_on_the_way(highest + 1)) ++highest;
  double best = start;
  for (int n = lowest; n <= highest; ++n) best = std::min(best, cost_at(blocked, n));
  const auto is_as_good = [&](int paces) {
    return lowest <= paces && paces <= highest && cost_at(blocked, paces) <= best + hardly;
  };
  int paces = 0; // 1, -1, 2, ...
  while (!is_as_good(paces)) paces = paces > 0 ? -paces : 1 - paces;
  return paces * pace;
}

} // namespace

std::vector<double> lifts_of(const Cloth& cloth, std::span<const Vec3> positions,
                             const Obstacles& obstacles) {
  const std::vector<Corners> triangles = triangles_of(obstacles);
  std::vector<double> lifts;
  for (std::size_t k = 0; k < cloth.pieces.size(); ++k) {
    std::vector<double> blocked = blocked_ways(ways_of(cloth, positions, k), triangles);
    sum_in_place(cloth.mesh.comm, blocked);
    lifts.push_back(best_lift(blocked));
  }
  return lifts;
}

} // namespace taut::command
