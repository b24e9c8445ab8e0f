#include "partition/partitioner.hpp"

#include "partition/ptscotch.hpp"

#include <metis.h>

#include <limits>
#include <numeric>

namespace taut {

namespace {

/// Everybody's part on rank 0, in rank order; empty elsewhere.
std::vector<idx_t> gather(MPI_Comm comm, const std::vector<idx_t>& part) {
  static_assert(sizeof(idx_t) == sizeof(int));
  const int count = int(part.size());
  std::vector<int> counts(size_of(comm)), offsets(size_of(comm), 0);
  MPI_Gather(&count, 1, MPI_INT, counts.data(), 1, MPI_INT, 0, comm);
  std::partial_sum(counts.begin(), counts.end() - 1, offsets.begin() + 1);
  std::vector<idx_t> all;
  if (rank_of(comm) == 0) all.resize(std::size_t(offsets.back()) + counts.back());
  MPI_Gatherv(part.data(), count, MPI_INT, all.data(), counts.data(), offsets.data(), MPI_INT, 0, comm);
  return all;
}

std::vector<int> scatter(MPI_Comm comm, const Slab& slab, const std::vector<idx_t>& all) {
  std::vector<int> counts(size_of(comm)), offsets(size_of(comm));
  for (int r = 0; r < size_of(comm); ++r) {
    const Slab s = slab_of(slab.total, size_of(comm), r);
    counts[r] = int(s.count);
    offsets[r] = int(s.first);
  }
  std::vector<int> part(slab.count);
  MPI_Scatterv(all.data(), counts.data(), offsets.data(), MPI_INT, part.data(), int(slab.count), MPI_INT, 0,
               comm);
  return part;
}

/// `work` may be empty.
std::vector<idx_t> metis_k_way(const std::vector<idx_t>& degrees, std::vector<idx_t>& neighbours,
                               std::vector<idx_t>& work, idx_t parts) {
  idx_t vertices = idx_t(degrees.size()), constraints = 1, cut = 0;
  std::vector<idx_t> offsets(degrees.size() + 1, 0), owner(degrees.size(), 0);
  std::partial_sum(degrees.begin(), degrees.end(), offsets.begin() + 1);
  idx_t options[METIS_NOPTIONS];
  METIS_SetDefaultOptions(options);
  options[METIS_OPTION_SEED] = 1;
  options[METIS_OPTION_UFACTOR] = 10; // at most 1 % over the mean
  const int status = METIS_PartGraphKway(&vertices, &constraints, offsets.data(), neighbours.data(),
                                         work.empty() ? nullptr : work.data(), nullptr, nullptr, &parts,
                                         nullptr, nullptr, options, &cut, owner.data());
  if (status != METIS_OK)
    throw InputError("METIS could not partition the mesh; try partition.method: stripes");
  return owner;
}

std::vector<int> stripes(const Slab& slab, int parts) {
  std::vector<int> part(slab.count);
  for (Global i = 0; i < slab.count; ++i) part[i] = slab_rank(slab.total, parts, slab.first + i);
  return part;
}

} // namespace

bool needs_graph(const Slab& vertices, Partitioner method, int parts) {
  return method != Partitioner::stripes && parts > 1 && parts < vertices.total;
}

std::vector<int> partition(MPI_Comm comm, const Slab& vertices, const PartitionGraph& graph,
                           Partitioner method, int parts) {
  if (!needs_graph(vertices, method, parts)) return stripes(vertices, parts);
  if (method == Partitioner::ptscotch) return ptscotch_parts(comm, vertices, graph, parts);
  const Global adjacencies = sum_over(comm, Global(graph.neighbours.size()));
  if (adjacencies > std::numeric_limits<idx_t>::max())
    throw InputError("the mesh has more edges than METIS can number; try partition.method: ptscotch");

  std::vector<idx_t> degrees(vertices.count);
  for (std::size_t i = 0; i < degrees.size(); ++i) degrees[i] = idx_t(graph.begin[i + 1] - graph.begin[i]);
  degrees = gather(comm, degrees);
  std::vector<idx_t> neighbours = gather(comm, {graph.neighbours.begin(), graph.neighbours.end()});
  std::vector<idx_t> work = gather(comm, {graph.work.begin(), graph.work.end()});
  std::vector<idx_t> owner;
  on_rank_0(comm, [&] { owner = metis_k_way(degrees, neighbours, work, parts); });
  return scatter(comm, vertices, owner);
}

} // namespace taut
