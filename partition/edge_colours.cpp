#include "partition/edge_colours.hpp"

#include <algorithm>

namespace taut {

namespace {

constexpr int none = -1;

/// Where an edge stands in the order: scrambled bits of its number [splitmix64], and the number itself.
std::pair<std::uint64_t, Global> place_of(Global original) {
  std::uint64_t z = std::uint64_t(original) + 0x9e3779b97f4a7c15u;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return {z ^ (z >> 31), original};
}

template<class Visit>
void for_each_neighbour(const DistributedMesh& mesh, Local edge, Visit&& visit) {
  for (const Local v : mesh.edge_vertices[edge])
    for (const EdgeEnd& end : mesh.star_of(v))
      if (end.edge != edge) visit(end.edge);
}

/// None as long as a neighbour that comes before has none.
int choose(const DistributedMesh& mesh, Local edge, const std::vector<int>& colour) {
  const auto place = place_of(mesh.edges.original[edge]);
  std::vector<char> taken;
  bool waits = false;
  for_each_neighbour(mesh, edge, [&](Local other) {
    if (place_of(mesh.edges.original[other]) > place) return;
    waits = waits || colour[other] == none;
    if (colour[other] == none) return;
    if (std::size_t(colour[other]) >= taken.size()) taken.resize(colour[other] + 1, 0);
    taken[colour[other]] = 1;
  });
  return waits ? none : int(std::find(taken.begin(), taken.end(), 0) - taken.begin());
}

} // namespace

EdgeColours colour_edges(const DistributedMesh& mesh) {
  std::vector<int> colour(mesh.edges.size(), none);
  std::vector<Local> left;
  for (Local e = 0; e < mesh.edges.owned; ++e) left.push_back(e);
  while (any_of(mesh.comm, !left.empty())) {
    std::erase_if(left, [&](Local e) { return (colour[e] = choose(mesh, e, colour)) != none; });
    mesh.edge_halo.update(colour);
  }
  int count = 0;
  for (const int c : colour) count = std::max(count, c + 1);
  EdgeColours result;
  result.edges.resize(std::size_t(max_over(mesh.comm, Global(count))));
  for (Local e = 0; e < mesh.edges.size(); ++e) {
    const auto& [a, b] = mesh.edge_vertices[e];
    if (mesh.owns_vertex(a) || mesh.owns_vertex(b)) result.edges[colour[e]].push_back(e);
  }
  return result;
}

} // namespace taut
