#include "partition/comm.hpp"

#include "partition/item_type.hpp"

#include <limits>
#include <stdexcept>

namespace taut {

int rank_of(MPI_Comm comm) {
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  return rank;
}

int size_of(MPI_Comm comm) {
  int size = 1;
  MPI_Comm_size(comm, &size);
  return size;
}

namespace {

template<class T>
T reduce(MPI_Comm comm, T value, MPI_Datatype type, MPI_Op op) {
  MPI_Allreduce(MPI_IN_PLACE, &value, 1, type, op, comm);
  return value;
}

} // namespace

Global sum_over(MPI_Comm comm, Global value) { return reduce(comm, value, MPI_INT64_T, MPI_SUM); }
double sum_over(MPI_Comm comm, double value) { return reduce(comm, value, MPI_DOUBLE, MPI_SUM); }
Global max_over(MPI_Comm comm, Global value) { return reduce(comm, value, MPI_INT64_T, MPI_MAX); }
double max_over(MPI_Comm comm, double value) { return reduce(comm, value, MPI_DOUBLE, MPI_MAX); }
bool any_of(MPI_Comm comm, bool value) { return reduce(comm, int(value), MPI_INT, MPI_LOR) != 0; }

void sum_in_place(MPI_Comm comm, std::span<double> values) {
  MPI_Allreduce(MPI_IN_PLACE, values.data(), int(values.size()), MPI_DOUBLE, MPI_SUM, comm);
}

void max_in_place(MPI_Comm comm, std::span<double> values) {
  MPI_Allreduce(MPI_IN_PLACE, values.data(), int(values.size()), MPI_DOUBLE, MPI_MAX, comm);
}

Global exclusive_sum(MPI_Comm comm, Global value) {
  Global before = 0;
  MPI_Exscan(&value, &before, 1, MPI_INT64_T, MPI_SUM, comm);
  return rank_of(comm) == 0 ? 0 : before;
}

std::string broadcast_text(MPI_Comm comm, const std::string& text, int root) {
  Global length = Global(text.size());
  MPI_Bcast(&length, 1, MPI_INT64_T, root, comm);
  std::string shared = rank_of(comm) == root ? text : std::string(std::size_t(length), '\0');
  MPI_Bcast(shared.data(), int(length), MPI_CHAR, root, comm);
  return shared;
}

void agree(MPI_Comm comm, const std::optional<std::string>& error) {
  int speaker = error ? rank_of(comm) : std::numeric_limits<int>::max();
  speaker = reduce(comm, speaker, MPI_INT, MPI_MIN);
  if (speaker == std::numeric_limits<int>::max()) return;
  throw InputError(broadcast_text(comm, error.value_or(""), speaker));
}

namespace detail {

std::vector<Global> offsets_of_incoming(MPI_Comm comm, std::span<const int> counts) {
  const int ranks = size_of(comm);
  std::vector<int> incoming(ranks);
  MPI_Alltoall(counts.data(), 1, MPI_INT, incoming.data(), 1, MPI_INT, comm);
  std::vector<Global> offsets(ranks + 1, 0);
  for (int r = 0; r < ranks; ++r) offsets[r + 1] = offsets[r] + incoming[r];
  return offsets;
}

void exchange_bytes(MPI_Comm comm, std::span<const std::byte> items, std::span<const int> counts,
                    std::span<std::byte> received, std::span<const Global> offsets, std::size_t item_size) {
  const ItemType item(item_size);
  std::vector<MPI_Request> requests;
  constexpr int tag = 101;
  for (int r = 0; r < size_of(comm); ++r) {
    const int count = int(offsets[r + 1] - offsets[r]);
    if (count == 0) continue;
    MPI_Irecv(received.data() + std::size_t(offsets[r]) * item_size, count, item, r, tag, comm,
              &requests.emplace_back());
  }
  std::size_t at = 0;
  for (int r = 0; r < size_of(comm); ++r) {
    if (counts[r] == 0) continue;
    MPI_Isend(items.data() + at, counts[r], item, r, tag, comm, &requests.emplace_back());
    at += std::size_t(counts[r]) * item_size;
  }
  MPI_Waitall(int(requests.size()), requests.data(), MPI_STATUSES_IGNORE);
}

std::vector<std::byte> gather_bytes(MPI_Comm comm, std::span<const std::byte> mine) {
  if (sum_over(comm, Global(mine.size())) > std::numeric_limits<int>::max())
    throw std::length_error("what all ranks have is too much to be gathered on each of them");
  const int count = int(mine.size());
  std::vector<int> counts(size_of(comm)), offsets(counts.size(), 0);
  MPI_Allgather(&count, 1, MPI_INT, counts.data(), 1, MPI_INT, comm);
  for (std::size_t r = 1; r < counts.size(); ++r) offsets[r] = offsets[r - 1] + counts[r - 1];
  std::vector<std::byte> all(std::size_t(offsets.back()) + std::size_t(counts.back()));
  MPI_Allgatherv(mine.data(), count, MPI_BYTE, all.data(), counts.data(), offsets.data(), MPI_BYTE, comm);
  return all;
}

} // namespace detail

} // namespace taut
