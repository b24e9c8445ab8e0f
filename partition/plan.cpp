#include "partition/plan.hpp"

#include "partition/item_type.hpp"
#include "partition/traffic.hpp"

#include <algorithm>
#include <numeric>

namespace taut {

Plan::Plan(MPI_Comm comm, std::span<const int> send_to, std::span<const Local> send_index,
           std::vector<Local> receive_index)
    : comm_(comm), receive_index_(std::move(receive_index)) {
  const int ranks = size_of(comm);
  std::vector<int> counts(ranks, 0), incoming(ranks, 0);
  for (const int r : send_to) ++counts[r];
  MPI_Alltoall(counts.data(), 1, MPI_INT, incoming.data(), 1, MPI_INT, comm);

  std::vector<std::size_t> order(send_to.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return send_to[a] < send_to[b]; });
  send_index_.reserve(order.size());
  for (const std::size_t i : order) send_index_.push_back(send_index[i]);

  const auto side = [ranks](const std::vector<int>& count) {
    Side s;
    for (int r = 0; r < ranks; ++r) {
      if (count[r] == 0) continue;
      s.ranks.push_back(r);
      s.offsets.push_back(s.offsets.back() + count[r]);
    }
    return s;
  };
  send_ = side(counts);
  receive_ = side(incoming);
}

void Plan::start(const Side& to, const Side& from, std::span<const std::byte> out, std::span<std::byte> in,
                 std::size_t item_size) const {
  const HaloScope halo;
  const detail::ItemType item(item_size);
  constexpr int tag = 102;
  requests_.clear();
  for (std::size_t k = 0; k < from.ranks.size(); ++k) {
    const std::size_t begin = from.offsets[k], end = from.offsets[k + 1];
    MPI_Irecv(in.data() + begin * item_size, int(end - begin), item, from.ranks[k], tag, comm_,
              &requests_.emplace_back());
  }
  for (std::size_t k = 0; k < to.ranks.size(); ++k) {
    const std::size_t begin = to.offsets[k], end = to.offsets[k + 1];
    MPI_Isend(out.data() + begin * item_size, int(end - begin), item, to.ranks[k], tag, comm_,
              &requests_.emplace_back());
  }
}

void Plan::finish() const { MPI_Waitall(int(requests_.size()), requests_.data(), MPI_STATUSES_IGNORE); }

} // namespace taut
