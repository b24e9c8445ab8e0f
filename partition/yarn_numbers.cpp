#include "partition/yarns.hpp"

#include "partition/fetch.hpp"

#include <algorithm>

namespace taut {

std::vector<Global> yarn_numbers(const DistributedMesh& mesh, const Yarns& yarns) {
  std::vector<Global> lowest(mesh.edges.owned); // original number of the lowest edge of each edge's yarn
  for (const YarnSegment& s : yarns.segments)
    std::fill(lowest.begin() + s.begin, lowest.begin() + s.end, s.yarn);
  const Slab slab = mesh.edge_order.slab();
  std::vector<Global> number = mesh.edge_order.to_slab<Global>(lowest);
  Global found = 0; // yarns whose lowest edge is in this slab, so far
  for (Global i = 0; i < slab.count; ++i) number[i] = number[i] == slab.first + i ? found++ : -1;
  const Global before = exclusive_sum(mesh.comm, found);
  for (Global& n : number) n += before;
  std::vector<Global> numbers = fetch<Global>(mesh.comm, slab, number, lowest);
  numbers.resize(mesh.edges.size());
  mesh.edge_halo.update(numbers);
  return numbers;
}

} // namespace taut
