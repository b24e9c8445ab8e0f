#include "partition/yarn_order.hpp"

#include <algorithm>
#include <numeric>

namespace taut {

namespace {

/// The edges at each vertex.
class EdgesAt {
public:
  explicit EdgesAt(std::span<const std::array<Local, 2>> edges) : edges_(edges), edge_(2 * edges.size()) {
    for (const auto& [a, b] : edges) {
      offsets_.resize(std::max(offsets_.size(), std::size_t(std::max(a, b)) + 2), 0);
      ++offsets_[a + 1];
      ++offsets_[b + 1];
    }
    std::partial_sum(offsets_.begin(), offsets_.end(), offsets_.begin());
    std::vector<std::size_t> next(offsets_);
    for (std::size_t e = 0; e < edges.size(); ++e)
      for (const Local v : edges[e]) edge_[next[v]++] = Local(e);
  }

  /// The edge between two vertices, -1 for none.
  Local between(Local a, Local b) const {
    if (std::size_t(a) + 1 >= offsets_.size()) return -1;
    for (std::size_t k = offsets_[a]; k < offsets_[a + 1]; ++k)
      if (edges_[edge_[k]][0] == b || edges_[edge_[k]][1] == b) return edge_[k];
    return -1;
  }

private:
  std::span<const std::array<Local, 2>> edges_;
  std::vector<std::size_t> offsets_{0};
  std::vector<Local> edge_;
};

/// The edges that continue each edge at its first and at its second vertex, -1 for none.
std::vector<std::array<Local, 2>> continuations(std::span<const std::array<Local, 2>> edges,
                                                std::span<const std::array<Local, 3>> triples) {
  const EdgesAt at(edges);
  std::vector<std::array<Local, 2>> next(edges.size(), {-1, -1});
  for (const auto& [before, centre, after] : triples) {
    const Local one = at.between(centre, before), two = at.between(centre, after);
    if (one < 0 || two < 0) continue;
    next[one][edges[one][0] == centre ? 0 : 1] = two;
    next[two][edges[two][0] == centre ? 0 : 1] = one;
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
