#include "partition/mesh_slab.hpp"

#include <algorithm>

namespace taut {

Slab slab_of(Global total, int ranks, int rank) {
  const Global each = total / ranks, more = total % ranks;
  return {rank * each + std::min<Global>(rank, more), each + (rank < more ? 1 : 0), total};
}

int slab_rank(Global total, int ranks, Global i) {
  const Global each = total / ranks, more = total % ranks;
  const Global in_larger = more * (each + 1);
  if (i < in_larger) return int(i / (each + 1));
  return int(more + (i - in_larger) / each);
}

} // namespace taut
