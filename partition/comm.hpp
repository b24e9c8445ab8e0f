#pragma once
#include "partition/error.hpp"
#include "partition/types.hpp"

#include <mpi.h>

#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

/// Small collective helpers. Everything here is collective over `comm` unless it says otherwise.
namespace taut {

int rank_of(MPI_Comm comm); ///< not collective
int size_of(MPI_Comm comm); ///< not collective

Global sum_over(MPI_Comm comm, Global value);
double sum_over(MPI_Comm comm, double value);
Global max_over(MPI_Comm comm, Global value);
double max_over(MPI_Comm comm, double value);
bool any_of(MPI_Comm comm, bool value);
void sum_in_place(MPI_Comm comm, std::span<double> values);
void max_in_place(MPI_Comm comm, std::span<double> values);

/// Sum of `value` over the ranks before this one.
Global exclusive_sum(MPI_Comm comm, Global value);

/// The text held by `root`, on every rank.
std::string broadcast_text(MPI_Comm comm, const std::string& text, int root = 0);

/// Throws the same `InputError` on every rank if any rank holds a message; the lowest such rank speaks.
void agree(MPI_Comm comm, const std::optional<std::string>& error);

/// Runs `function` on rank 0 only; its `InputError` reaches all ranks. Others wait until it has ended. The
/// one way to do something on a single rank that may fail.
template<class Function>
void on_rank_0(MPI_Comm comm, Function&& function) {
  std::optional<std::string> error;
  if (rank_of(comm) == 0) {
    try {
      std::forward<Function>(function)();
    } catch (const InputError& e) {
      error = e.what();
    }
  }
  agree(comm, error);
}

/// The text that `function` returns on rank 0, or its `InputError`, on all ranks.
template<class Function>
std::string broadcast(MPI_Comm comm, Function&& function) {
  std::string text;
  on_rank_0(comm, [&] { text = std::forward<Function>(function)(); });
  return broadcast_text(comm, text);
}

/// What `exchange` received: the items of rank 0, then of rank 1, ...; those of rank r are
/// [offsets[r], offsets[r + 1]).
template<class T>
struct Received {
  std::vector<T> items;
  std::vector<Global> offsets;
};

namespace detail {
/// How many items come from each rank, as offsets, if `counts` go to each.
std::vector<Global> offsets_of_incoming(MPI_Comm comm, std::span<const int> counts);

/// Sends `counts` items of `item_size` bytes to each rank; those of rank r go to `received` from offsets[r]
/// on.
void exchange_bytes(MPI_Comm comm, std::span<const std::byte> items, std::span<const int> counts,
                    std::span<std::byte> received, std::span<const Global> offsets, std::size_t item_size);

/// What all ranks have, in the order of ranks.
std::vector<std::byte> gather_bytes(MPI_Comm comm, std::span<const std::byte> mine);
} // namespace detail

/// The items of all ranks, in the order of ranks, on every rank. For set-up, and only of what stays small.
template<class T>
std::vector<T> gather_to_all(MPI_Comm comm, std::span<const T> mine) {
  const std::vector<std::byte> bytes = detail::gather_bytes(comm, std::as_bytes(mine));
  std::vector<T> all(bytes.size() / sizeof(T));
  std::memcpy(static_cast<void*>(all.data()), bytes.data(), bytes.size());
  return all;
}

/// Personalised exchange: sends `items[i]` to rank `destinations[i]`; the order among the items of one pair
/// of ranks is kept. For set-up only: it costs one message a pair of ranks that have something to say, and
/// O(ranks) memory.
template<class T>
Received<T> exchange(MPI_Comm comm, std::span<const T> items, std::span<const int> destinations) {
  static_assert(std::is_trivially_copyable_v<T> || std::is_standard_layout_v<T>);
  const int ranks = size_of(comm);
  std::vector<int> counts(ranks, 0);
  for (const int d : destinations) ++counts[d];
  std::vector<std::size_t> at(ranks, 0);
  for (int r = 1; r < ranks; ++r) at[r] = at[r - 1] + counts[r - 1];
  std::vector<T> sorted(items.size());
  for (std::size_t i = 0; i < items.size(); ++i) sorted[at[destinations[i]]++] = items[i];
  Received<T> received;
  received.offsets = detail::offsets_of_incoming(comm, counts);
  received.items.resize(std::size_t(received.offsets.back()));
  detail::exchange_bytes(comm, std::as_bytes(std::span<const T>(sorted)), counts,
                         std::as_writable_bytes(std::span(received.items)), received.offsets, sizeof(T));
  return received;
}

template<class T>
Received<T> exchange(MPI_Comm comm, const std::vector<T>& items, const std::vector<int>& destinations) {
  return exchange<T>(comm, std::span<const T>(items), std::span<const int>(destinations));
}

} // namespace taut
