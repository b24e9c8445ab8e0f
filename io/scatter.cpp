#include "io/scatter.hpp"

#include <algorithm>

namespace taut::detail {
namespace {

constexpr std::size_t largest_message = std::size_t{1}
                                        << 26; ///< bytes; far within an int, and enough for speed
constexpr int tag = 0;

/// Cuts `bytes` into pieces that one message can hold.
template<class Byte, class Move>
void in_messages(std::span<Byte> bytes, Move&& move) {
  while (!bytes.empty()) {
    const std::size_t size = std::min(bytes.size(), largest_message);
    move(bytes.data(), static_cast<int>(size));
    bytes = bytes.subspan(size);
  }
}

} // namespace

void scatter_bytes(MPI_Comm comm, std::span<const std::byte> all, Global total, std::size_t item_size,
                   std::span<std::byte> mine) {
  if (rank_of(comm) != 0) {
    in_messages(mine, [&](std::byte* data, int size) {
      MPI_Recv(data, size, MPI_BYTE, 0, tag, comm, MPI_STATUS_IGNORE);
    });
    return;
  }
  const int ranks = size_of(comm);
  for (int rank = 1; rank < ranks; ++rank) {
    const Slab slab = slab_of(total, ranks, rank);
    in_messages(all.subspan(slab.first * item_size, slab.count * item_size),
                [&](const std::byte* data, int size) { MPI_Send(data, size, MPI_BYTE, rank, tag, comm); });
  }
  std::copy_n(all.begin(), mine.size(), mine.begin()); // the slab of rank 0 is the first
}

} // namespace taut::detail
