#pragma once
#include "partition/mesh_slab.hpp"

#include <mpi.h>

#include <cstddef>
#include <span>
#include <type_traits>
#include <vector>

namespace taut {

namespace detail {
void scatter_bytes(MPI_Comm comm, std::span<const std::byte> all, Global total, std::size_t item_size,
                   std::span<std::byte> mine);
} // namespace detail

/// The rank's slab (`slab_of`) of the list `all` that rank 0 holds (empty elsewhere). Collective; `mine` is
/// the slab of this rank and its total the length of `all`.
template<class T>
std::vector<T> scatter_slabs(MPI_Comm comm, const std::vector<T>& all, Slab mine) {
  static_assert(std::is_standard_layout_v<T>);
  std::vector<T> items(static_cast<std::size_t>(mine.count));
  detail::scatter_bytes(comm, std::as_bytes(std::span(all)), mine.total, sizeof(T),
                        std::as_writable_bytes(std::span(items)));
  return items;
}

} // namespace taut
