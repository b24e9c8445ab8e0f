#pragma once
#include "partition/mesh_slab.hpp"

namespace taut {

/// Values of a slab-distributed array at any entities: `values` holds this rank's slab, the result one value
/// for each of `wanted`, in that order. Collective; for set-up.
template<class T>
std::vector<T> fetch(MPI_Comm comm, const Slab& slab, std::span<const T> values,
                     std::span<const Global> wanted) {
  const int ranks = size_of(comm);
  std::vector<int> holder(wanted.size());
  for (std::size_t i = 0; i < wanted.size(); ++i) holder[i] = slab_rank(slab.total, ranks, wanted[i]);
  const auto asked = exchange<Global>(comm, wanted, holder);

  std::vector<T> answers(asked.items.size());
  std::vector<int> asker(asked.items.size());
  for (int r = 0; r < ranks; ++r)
    for (Global i = asked.offsets[r]; i < asked.offsets[r + 1]; ++i) {
      answers[i] = values[asked.items[i] - slab.first];
      asker[i] = r;
    }
  const auto answered = exchange(comm, answers, asker);

  std::vector<Global> next(answered.offsets.begin(), answered.offsets.end());
  std::vector<T> result(wanted.size());
  for (std::size_t i = 0; i < wanted.size(); ++i) result[i] = answered.items[next[holder[i]]++];
  return result;
}

} // namespace taut
