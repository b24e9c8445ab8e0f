#include "partition/index_map.hpp"

#include <algorithm>
#include <numeric>

namespace taut {

namespace {

/// Local numbers of owned entities by their original number.
class OwnedLookup {
public:
  explicit OwnedLookup(std::span<const Global> original)
      : by_original_(original.size()), original_(original) {
    std::iota(by_original_.begin(), by_original_.end(), 0);
    std::sort(by_original_.begin(), by_original_.end(),
              [&](Local a, Local b) { return original_[a] < original_[b]; });
  }

  Local operator()(Global original) const {
    const auto at = std::lower_bound(by_original_.begin(), by_original_.end(), original,
                                     [&](Local i, Global value) { return original_[i] < value; });
    return *at;
  }

private:
  std::vector<Local> by_original_;
  std::span<const Global> original_;
};

} // namespace

Halo::Halo(MPI_Comm comm, IndexMap& map) {
  map.first = exclusive_sum(comm, map.owned);
  map.total = sum_over(comm, Global(map.owned));

  // Ghosts ask their owners; what an owner is asked for is what it sends from then on.
  const std::span<const Global> original(map.original);
  const auto asked = exchange<Global>(comm, original.subspan(map.owned), map.ghost_owners);
  const OwnedLookup local_of(original.first(map.owned));
  std::vector<int> send_to;
  std::vector<Local> send_index;
  std::vector<Global> numbers;
  for (int r = 0; r < size_of(comm); ++r)
    for (Global i = asked.offsets[r]; i < asked.offsets[r + 1]; ++i) {
      send_to.push_back(r);
      send_index.push_back(local_of(asked.items[i]));
      numbers.push_back(map.first + send_index.back());
    }
  map.ghost_globals = exchange(comm, numbers, send_to).items;

  std::vector<Local> ghosts(map.ghost_owners.size());
  std::iota(ghosts.begin(), ghosts.end(), map.owned);
  plan_ = Plan(comm, send_to, send_index, std::move(ghosts));
}

OriginalOrder::OriginalOrder(MPI_Comm comm, Global total, std::span<const Global> original)
    : slab_(slab_of(total, size_of(comm), rank_of(comm))) {
  std::vector<int> send_to(original.size());
  for (std::size_t i = 0; i < original.size(); ++i) send_to[i] = slab_rank(total, size_of(comm), original[i]);
  const auto arriving = exchange<Global>(comm, original, send_to);
  std::vector<Local> place(arriving.items.size());
  for (std::size_t i = 0; i < place.size(); ++i) place[i] = Local(arriving.items[i] - slab_.first);
  std::vector<Local> send_index(original.size());
  std::iota(send_index.begin(), send_index.end(), 0);
  plan_ = Plan(comm, send_to, send_index, std::move(place));
}

} // namespace taut
