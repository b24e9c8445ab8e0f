#include "partition/partition_graph.hpp"

#include "partition/fetch.hpp"

#include <algorithm>
#include <iterator>

namespace taut {

PartitionGraph graph_of(const Topology& topology) {
  PartitionGraph graph{topology.star, {}, {}};
  for (const Spoke& s : topology.spokes) graph.neighbours.push_back(s.neighbour);
  return graph;
}

PartitionGraph graph_of(const Topology& topology, const NearVertices& near) {
  const PartitionGraph mesh = graph_of(topology);
  PartitionGraph graph{{0}, {}, {}};
  for (std::size_t i = 0; i + 1 < mesh.begin.size(); ++i) {
    const auto star = std::span(mesh.neighbours).subspan(mesh.begin[i], mesh.begin[i + 1] - mesh.begin[i]);
    const auto others = std::span(near.others).subspan(near.begin[i], near.begin[i + 1] - near.begin[i]);
    std::ranges::set_union(star, others, std::back_inserter(graph.neighbours));
    graph.begin.push_back(graph.neighbours.size());
    graph.work.push_back(int(1 + graph.begin[i + 1] - graph.begin[i] - star.size()));
  }
  return graph;
}

double mean_edge(MPI_Comm comm, const MeshSlab& mesh, const Topology& topology) {
  std::vector<Global> ends;
  for (const Spoke& s : topology.spokes) ends.push_back(s.neighbour);
  const auto places = fetch<Vec3>(comm, mesh.vertices, mesh.rest_positions, ends);
  std::array<double, 2> sums{0, double(ends.size())};
  for (std::size_t k = 0; k < ends.size(); ++k)
    sums[0] += (places[k] - mesh.rest_positions[topology.spokes[k].centre - mesh.vertices.first]).norm();
  sum_in_place(comm, sums);
  return sums[1] > 0 ? sums[0] / sums[1] : 0.0;
}

} // namespace taut
