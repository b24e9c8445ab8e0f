#include "partition/yarn_order.hpp"

#include <algorithm>
#include <unordered_map>

namespace taut {

namespace {

/// The edges that continue each edge at its first and at its second vertex, -1 for none.
std::vector<std::array<Local, 2>> continuations(std::span<const std::array<Local, 2>> edges,
                                                std::span<const std::array<Local, 3>> triples) {
  const auto key = [](Local a, Local b) {
    return std::uint64_t(std::uint32_t(std::min(a, b))) << 32 | std::uint32_t(std::max(a, b));
  };
  std::unordered_map<std::uint64_t, Local> edge_of;
  edge_of.reserve(edges.size());
  for (std::size_t e = 0; e < edges.size(); ++e) edge_of[key(edges[e][0], edges[e][1])] = Local(e);

  std::vector<std::array<Local, 2>> next(edges.size(), {-1, -1});
  for (const auto& [before, centre, after] : triples) {
    const auto one = edge_of.find(key(before, centre)), two = edge_of.find(key(centre, after));
    if (one == edge_of.end() || two == edge_of.end()) continue;
    for (const auto& [e, f] : {std::pair{one->second, two->second}, std::pair{two->second, one->second}})
      next[e][edges[e][0] == centre ? 0 : 1] = f;
  }
  return next;
}

} // namespace

std::vector<Local> order_by_yarn(std::span<const std::array<Local, 2>> edges,
                                 std::span<const std::array<Local, 3>> triples) {
  const auto next = continuations(edges, triples);
  std::vector<Local> order;
  std::vector<char> placed(edges.size(), 0);
  order.reserve(edges.size());
  const auto walk = [&](Local e, Local previous) {
    while (e >= 0 && !placed[e]) {
      order.push_back(e);
      placed[e] = 1;
      const Local onward = next[e][0] != previous ? next[e][0] : next[e][1];
      previous = e;
      e = onward;
    }
  };
  for (std::size_t e = 0; e < edges.size(); ++e) // open yarns, from an end
    if (!placed[e] && (next[e][0] < 0 || next[e][1] < 0)) walk(Local(e), -1);
  for (std::size_t e = 0; e < edges.size(); ++e) // what is left is closed
    if (!placed[e]) walk(Local(e), next[e][0]);
  return order;
}

} // namespace taut
