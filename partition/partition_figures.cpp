#include "partition/partition_figures.hpp"

#include "partition/distributed_mesh.hpp"
#include "partition/fetch.hpp"
#include "partition/sort_unique.hpp"
#include "partition/triangle_hinges.hpp"
#include "partition/yarns.hpp"

#include <algorithm>
#include <limits>

namespace taut {

namespace {

/// An entity that `part` stores and `owner` owns.
struct Stored {
  int part, owner;
  Global entity;
  auto operator<=>(const Stored&) const = default;
};

/// Each part has a home, the rank that counts what concerns it.
class Counter {
public:
  Counter(MPI_Comm comm, int parts)
      : comm_(comm), parts_(parts), slab_(slab_of(parts, size_of(comm), rank_of(comm))) {}

  /// What all ranks know of the parts whose home is here, sorted.
  template<class T>
  std::vector<T> bring_home(const std::vector<T>& items) const {
    std::vector<int> homes;
    for (const T& item : items) homes.push_back(slab_rank(parts_, size_of(comm_), item.part));
    auto arrived = exchange(comm_, items, homes).items;
    std::sort(arrived.begin(), arrived.end());
    return arrived;
  }

  /// How often each part is named, `items` being at the homes of their parts.
  template<class T>
  Spread spread(const std::vector<T>& items) const {
    std::vector<Global> counts(slab_.count, 0);
    for (const T& item : items) ++counts[item.part - slab_.first];
    Global sum = 0, most = 0, least = std::numeric_limits<Global>::max();
    for (const Global c : counts) {
      sum += c;
      most = std::max(most, c);
      least = std::min(least, c);
    }
    return {-max_over(comm_, -least), max_over(comm_, most), double(sum_over(comm_, sum)) / parts_};
  }

private:
  MPI_Comm comm_;
  int parts_;
  Slab slab_;
};

/// Appends that each of the parts `storing` stores entity `number`, unless it owns it.
void store(std::vector<Stored>& stored, const std::vector<int>& storing, int owner, Global number) {
  for (const int part : storing)
    if (part != owner) stored.push_back({part, owner, number});
}

/// All parts that meet in one entity store all its vertices.
void store_together(std::vector<Stored>& stored, std::span<const Global> vertices,
                    std::span<const int> owners) {
  std::vector<int> meeting(owners.begin(), owners.end());
  sort_unique(meeting);
  for (std::size_t k = 0; k < owners.size(); ++k) store(stored, meeting, owners[k], vertices[k]);
}

/// The ghosts of all parts: of cells, stars and hinges, as `distribute` sends them.
struct Ghosts {
  std::vector<Stored> vertices, edges;
};

void store_cells(MPI_Comm comm, const MeshSlab& mesh, const std::vector<int>& owners, Ghosts& ghosts) {
  std::vector<Global> wanted;
  for (const Cell& c : mesh.cell)
    wanted.insert(wanted.end(), c.vertices.begin(), c.vertices.begin() + c.size());
  const auto owner = fetch<int>(comm, mesh.vertices, owners, wanted);
  std::size_t at = 0;
  for (const Cell& c : mesh.cell) {
    store_together(ghosts.vertices, c.vertices, std::span(owner).subspan(at, std::size_t(c.size())));
    at += std::size_t(c.size());
  }
}

void store_hinges(MPI_Comm comm, const MeshSlab& mesh, const Topology& topology,
                  const std::vector<int>& owners, Ghosts& ghosts) {
  std::vector<Global> wanted;
  for (const EdgeFaces& h : topology.hinges)
    for (const Global v : vertices_of(h)) wanted.push_back(v);
  const auto owner = fetch<int>(comm, mesh.vertices, owners, wanted);
  for (std::size_t k = 0; k < topology.hinges.size(); ++k)
    store_together(ghosts.vertices, std::span(wanted).subspan(6 * k, 6), std::span(owner).subspan(6 * k, 6));
}

void store_hinges_of_triangles(MPI_Comm comm, const MeshSlab& mesh, const Topology& topology,
                               const std::vector<int>& owners, Ghosts& ghosts) {
  const auto triangles = hinges_of_triangles(comm, mesh.vertices, topology.hinges);
  std::vector<Global> wanted;
  for (const HingesOfTriangle& t : triangles)
    for (const Global v : t.vertices()) wanted.push_back(v);
  const auto owner = fetch<int>(comm, mesh.vertices, owners, wanted);
  std::size_t at = 0;
  for (const HingesOfTriangle& t : triangles) {
    const std::size_t n = 6 * t.hinges.size();
    store_together(ghosts.vertices, std::span(wanted).subspan(at, n), std::span(owner).subspan(at, n));
    at += n;
  }
}

/// A star is stored by the parts of its centre and of all neighbours. Returns the edges that are cut, each
/// once.
Global store_stars(MPI_Comm comm, const MeshSlab& mesh, const Topology& topology,
                   const std::vector<int>& owners, Ghosts& ghosts) {
  std::vector<Global> wanted;
  for (const Spoke& s : topology.spokes) wanted.push_back(s.neighbour);
  const auto owner = fetch<int>(comm, mesh.vertices, owners, wanted);
  Global cut = 0;
  std::vector<int> around;
  for (Global v = 0; v < mesh.vertices.count; ++v) {
    around.assign(owner.begin() + topology.star[v], owner.begin() + topology.star[v + 1]);
    around.push_back(owners[v]);
    sort_unique(around);
    for (std::size_t i = topology.star[v]; i < topology.star[v + 1]; ++i) {
      const Spoke& s = topology.spokes[i];
      if (s.edge < 0) continue;
      store(ghosts.vertices, around, owners[v], s.centre);
      store(ghosts.vertices, around, owner[i], s.neighbour);
      store(ghosts.edges, around, s.centre < s.neighbour ? owners[v] : owner[i], s.edge);
      cut += s.centre < s.neighbour && owners[v] != owner[i];
    }
  }
  return cut;
}

struct Named {
  int part;
  auto operator<=>(const Named&) const = default;
};

void count_ghosts(const Counter& counter, Ghosts& ghosts, PartitionFigures& figures) {
  for (auto* stored : {&ghosts.vertices, &ghosts.edges}) {
    sort_unique(*stored);
    *stored = counter.bring_home(*stored);
    sort_unique(*stored);
  }
  figures.ghosts = counter.spread(ghosts.vertices);
  figures.ghost_edges = counter.spread(ghosts.edges);
  std::vector<Stored> neighbours;
  for (const Stored& s : ghosts.vertices) neighbours.push_back({s.part, s.owner, 0});
  sort_unique(neighbours);
  figures.neighbours = counter.spread(neighbours);
}

/// An edge of a yarn in a part, or the link between two such edges that follow one another.
struct YarnPiece {
  int part;
  Global yarn;
  int segments; ///< +1 for an edge, -1 for a link: they add up to the yarn's segments in the part
  auto operator<=>(const YarnPiece&) const = default;
};

std::vector<YarnPiece> yarn_pieces(const MeshSlab& slab, const DistributedMesh& mesh, const Yarns& yarns,
                                   const std::vector<int>& owners) {
  const std::vector<Global> yarn = yarn_numbers(mesh, yarns);
  std::vector<Global> lower;
  for (const auto& ends : mesh.edge_vertices) lower.push_back(mesh.vertices.original[ends[0]]);
  const auto part = fetch<int>(mesh.comm, slab.vertices, owners, lower);
  std::vector<YarnPiece> pieces;
  for (Local e = 0; e < mesh.edges.owned; ++e) pieces.push_back({part[e], yarn[e], 1});
  const auto link = [&](Local e, Local f) {
    if (part[e] == part[f]) pieces.push_back({part[e], yarn[f], -1});
  };
  for (const YarnSegment& s : yarns.segments)
    for (Local e = s.begin + 1; e < s.end; ++e) link(e - 1, e);
  for (std::size_t k = 0; k < yarns.knots.size(); ++k)
    if (yarns.before_knot[k] >= 0) link(yarns.before_knot[k], yarns.knots[k]);
  return pieces;
}

void count_yarns(MPI_Comm comm, const Counter& counter, const std::vector<YarnPiece>& pieces, Global yarns,
                 PartitionFigures& figures) {
  const auto here = counter.bring_home(pieces);
  std::vector<Named> segments;
  std::vector<Global> met;
  std::vector<int> to;
  for (std::size_t i = 0; i < here.size();) {
    const auto [part, yarn, first] = here[i];
    int open = 0;
    for (; i < here.size() && here[i].part == part && here[i].yarn == yarn; ++i) open += here[i].segments;
    segments.insert(segments.end(), std::size_t(open), {part});
    met.push_back(yarn);
    to.push_back(slab_rank(yarns, size_of(comm), yarn));
  }
  figures.yarns = yarns;
  figures.yarn_segments = counter.spread(segments);
  auto parts_of_yarns = exchange(comm, met, to).items;
  std::sort(parts_of_yarns.begin(), parts_of_yarns.end());
  Global cut = 0;
  for (std::size_t i = 1; i < parts_of_yarns.size(); ++i)
    cut +=
        parts_of_yarns[i] == parts_of_yarns[i - 1] && (i == 1 || parts_of_yarns[i] != parts_of_yarns[i - 2]);
  figures.cut_yarns = sum_over(comm, cut);
}

} // namespace

PartitionFigures partition_figures(MPI_Comm comm, const MeshSlab& mesh, const Topology& topology,
                                   const std::vector<int>& owners, int parts) {
  PartitionFigures figures;
  figures.parts = parts;
  const Counter counter(comm, parts);
  std::vector<Named> owned;
  for (const int part : owners) owned.push_back({part});
  figures.vertices = counter.spread(counter.bring_home(owned));
  figures.imbalance = double(figures.vertices.max) / figures.vertices.mean;
  Ghosts ghosts;
  store_cells(comm, mesh, owners, ghosts);
  store_hinges(comm, mesh, topology, owners, ghosts);
  store_hinges_of_triangles(comm, mesh, topology, owners, ghosts);
  figures.edge_cut = sum_over(comm, store_stars(comm, mesh, topology, owners, ghosts));
  count_ghosts(counter, ghosts, figures);

  // The yarns do not depend on the partition: they are found on another, one part a rank.
  const DistributedMesh whole =
      distribute(comm, mesh, topology, partition(comm, mesh, topology, Partitioner::stripes));
  const Yarns yarns = find_yarns(whole);
  count_yarns(comm, counter, yarn_pieces(mesh, whole, yarns, owners), yarns.count, figures);
  return figures;
}

} // namespace taut
