#include "partition/distributed_mesh.hpp"

#include "partition/fetch.hpp"
#include "partition/mesh_parts.hpp"
#include "partition/morton.hpp"
#include "partition/sort_unique.hpp"
#include "partition/yarn_order.hpp"

#include <algorithm>
#include <numeric>
#include <tuple>
#include <unordered_map>

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace taut {

namespace {

/// Builds the mesh from its parts; holds what is needed only while building.
class Builder {
public:
  Builder(MPI_Comm comm, const MeshSlab& slab, const std::vector<int>& owners)
      : slab_(slab), owners_(owners) {
    mesh_.comm = comm;
  }

  DistributedMesh build(MeshParts&& parts) {
    number_vertices(parts);
    place_cells(parts.cells);
    place_triples(parts.triples);
    place_hinges(parts.hinges);
    number_edges(parts.edges);
    place_pairs(parts.seams, mesh_.seams);
    place_pairs(parts.ties, mesh_.ties);
    collect_stars();
    order_for_files();
    report();
    return std::move(mesh_);
  }

private:
  void number_vertices(MeshParts& parts) {
    find_box();
    std::sort(parts.vertices.begin(), parts.vertices.end(), [this](const SentVertex& a, const SentVertex& b) {
      return std::pair(key(a.rest_position), a.original) < std::pair(key(b.rest_position), b.original);
    });
    IndexMap& map = mesh_.vertices;
    map.owned = Local(parts.vertices.size());
    for (const SentVertex& v : parts.vertices) {
      map.original.push_back(v.original);
      mesh_.rest_positions.push_back(v.rest_position);
      mesh_.joint.push_back(v.joint);
    }
    append_ghost_vertices(parts);
    mesh_.vertex_halo = Halo(mesh_.comm, map);
    mesh_.rest_positions.resize(map.size());
    mesh_.vertex_halo.update(mesh_.rest_positions);
    mesh_.joint.resize(map.size());
    mesh_.vertex_halo.update(mesh_.joint);
    for (Local i = 0; i < map.size(); ++i) local_of_[map.original[i]] = i;
  }

  void find_box() {
    std::array<double, 6> extent;
    extent.fill(-std::numeric_limits<double>::infinity());
    for (const Vec3& x : slab_.rest_positions)
      for (int k = 0; k < 3; ++k) {
        extent[k] = std::max(extent[k], x[k]);
        extent[3 + k] = std::max(extent[3 + k], -x[k]);
      }
    max_in_place(mesh_.comm, extent);
    low_ = -Vec3(extent[3], extent[4], extent[5]);
    side_ = std::max((Vec3(extent[0], extent[1], extent[2]) - low_).maxCoeff(), 1e-300);
  }

  std::uint64_t key(const Vec3& x) const { return morton_key(x, low_, side_); }
  auto place_of(Local vertex) const {
    return std::pair(key(mesh_.rest_positions[vertex]), mesh_.vertices.original[vertex]);
  }

  void append_ghost_vertices(const MeshParts& parts) {
    std::vector<Global> met;
    for (const SentCell& c : parts.cells)
      met.insert(met.end(), c.cell.vertices.begin(), c.cell.vertices.begin() + c.cell.size());
    for (const SentEdge& e : parts.edges) met.insert(met.end(), {e.low, e.high});
    for (const EdgeFaces& h : parts.hinges)
      for (const Global v : vertices_of(h)) met.push_back(v);
    for (const auto* pairs : {&parts.seams, &parts.ties})
      for (const VertexPair& pair : *pairs) met.insert(met.end(), pair.begin(), pair.end());
    sort_unique(met);
    std::vector<Global> mine(mesh_.vertices.original);
    std::sort(mine.begin(), mine.end());
    std::vector<Global> ghosts;
    std::set_difference(met.begin(), met.end(), mine.begin(), mine.end(), std::back_inserter(ghosts));
    const auto owner = fetch<int>(mesh_.comm, slab_.vertices, owners_, ghosts);
    append_by_owner(mesh_.vertices, ghosts, owner);
  }

  static void append_by_owner(IndexMap& map, std::span<const Global> ghosts, std::span<const int> owner) {
    std::vector<std::size_t> order(ghosts.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return owner[a] < owner[b]; });
    for (const std::size_t i : order) {
      map.original.push_back(ghosts[i]);
      map.ghost_owners.push_back(owner[i]);
    }
  }

  void place_cells(const std::vector<SentCell>& cells) {
    mesh_.total_cells = slab_.cells.total;
    std::vector<std::pair<LocalCell, const SentCell*>> placed;
    for (const SentCell& c : cells) {
      LocalCell cell{{-1, -1, -1, -1}};
      for (int k = 0; k < c.cell.size(); ++k) cell.vertices[k] = local_of_.at(c.cell.vertices[k]);
      placed.emplace_back(cell, &c);
    }
    std::sort(placed.begin(), placed.end(), [this](const auto& a, const auto& b) {
      return std::pair(place_of(a.first.vertices[0]), a.second->original) <
             std::pair(place_of(b.first.vertices[0]), b.second->original);
    });
    const bool has_texture = any_of(mesh_.comm, !slab_.texture.empty());
    const bool has_rest_shape = any_of(mesh_.comm, !slab_.rest_shape.empty());
    for (const auto& [cell, sent] : placed) {
      if (mesh_.owns_vertex(cell.vertices[0])) {
        mesh_.owned_cells.push_back(Local(mesh_.cells.size()));
        mesh_.owned_cell_originals.push_back(sent->original);
      }
      mesh_.cells.push_back(cell);
      mesh_.cell_originals.push_back(sent->original);
      if (has_texture) mesh_.texture.push_back(sent->texture);
      if (has_rest_shape) mesh_.rest_shape.push_back(sent->rest_shape);
    }
  }

  void place_triples(const std::vector<YarnTriple>& triples) {
    for (const YarnTriple& t : triples)
      mesh_.triples.push_back({local_of_.at(t.before), local_of_.at(t.centre), local_of_.at(t.after)});
    std::sort(mesh_.triples.begin(), mesh_.triples.end(), [this](const auto& a, const auto& b) {
      return std::pair(place_of(a[1]), mesh_.vertices.original[a[0]]) <
             std::pair(place_of(b[1]), mesh_.vertices.original[b[0]]);
    });
  }

  void place_hinges(const std::vector<EdgeFaces>& hinges) {
    const auto local = [this](Global v) { return v < 0 ? Local(-1) : local_of_.at(v); };
    for (const EdgeFaces& h : hinges)
      mesh_.hinges.push_back({{local(h.low), local(h.high)},
                              {local(h.left[0]), local(h.left[1])},
                              {local(h.right[0]), local(h.right[1])},
                              h.cells,
                              h.run,
                              h.at_rest});
    std::sort(mesh_.hinges.begin(), mesh_.hinges.end(), [this](const Hinge& a, const Hinge& b) {
      return std::pair(place_of(a.edge[0]), mesh_.vertices.original[a.edge[1]]) <
             std::pair(place_of(b.edge[0]), mesh_.vertices.original[b.edge[1]]);
    });
  }

  /// In an order that does not depend on the partition.
  void place_pairs(std::vector<VertexPair>& pairs, std::vector<std::array<Local, 2>>& placed) const {
    std::sort(pairs.begin(), pairs.end());
    for (const auto& [a, b] : pairs) placed.push_back({local_of_.at(a), local_of_.at(b)});
  }

  void number_edges(const std::vector<SentEdge>& edges) {
    std::vector<SentEdge> owned, ghosts;
    std::vector<int> ghost_owners;
    for (const SentEdge& e : edges) {
      const Local low = local_of_.at(e.low);
      if (mesh_.owns_vertex(low)) {
        owned.push_back(e);
      } else {
        ghosts.push_back(e);
        ghost_owners.push_back(mesh_.vertices.ghost_owners[low - mesh_.vertices.owned]);
      }
    }
    std::vector<std::array<Local, 2>> ends;
    for (const SentEdge& e : owned) ends.push_back({local_of_.at(e.low), local_of_.at(e.high)});
    IndexMap& map = mesh_.edges;
    map.owned = Local(owned.size());
    std::unordered_map<Global, std::array<Local, 2>> ghost_ends;
    for (const Local i : order_by_yarn(ends, mesh_.triples)) {
      map.original.push_back(owned[i].original);
      mesh_.edge_vertices.push_back(ends[i]);
    }
    std::vector<Global> ghost_numbers;
    for (const SentEdge& e : ghosts) {
      ghost_numbers.push_back(e.original);
      ghost_ends[e.original] = {local_of_.at(e.low), local_of_.at(e.high)};
    }
    append_by_owner(map, ghost_numbers, ghost_owners);
    for (Local i = map.owned; i < Local(map.original.size()); ++i)
      mesh_.edge_vertices.push_back(ghost_ends.at(map.original[i]));
    mesh_.edge_halo = Halo(mesh_.comm, map);
    std::unordered_map<Global, double> lengths;
    for (const SentEdge& e : edges) lengths[e.original] = e.rest_length;
    for (std::size_t e = 0; e < mesh_.edge_vertices.size(); ++e) {
      const auto& [a, b] = mesh_.edge_vertices[e];
      const double given = lengths.at(map.original[e]);
      mesh_.rest_lengths.push_back(given > 0 ? given
                                             : (mesh_.rest_positions[b] - mesh_.rest_positions[a]).norm());
    }
  }

  void collect_stars() {
    const auto& edges = mesh_.edge_vertices;
    std::vector<Local> by_original(edges.size());
    std::iota(by_original.begin(), by_original.end(), 0);
    std::sort(by_original.begin(), by_original.end(),
              [&](Local a, Local b) { return mesh_.edges.original[a] < mesh_.edges.original[b]; });
    mesh_.star.assign(mesh_.vertices.size() + 1, 0);
    for (const auto& e : edges)
      for (const Local v : e) ++mesh_.star[v + 1];
    std::partial_sum(mesh_.star.begin(), mesh_.star.end(), mesh_.star.begin());
    mesh_.ends.resize(mesh_.star.back());
    std::vector<std::size_t> at(mesh_.star.begin(), mesh_.star.end() - 1);
    for (const Local e : by_original) {
      mesh_.ends[at[edges[e][0]]++] = {e, edges[e][1], -1.0f};
      mesh_.ends[at[edges[e][1]]++] = {e, edges[e][0], +1.0f};
    }
  }

  void order_for_files() {
    const std::span<const Global> vertices(mesh_.vertices.original), edges(mesh_.edges.original);
    mesh_.vertex_order =
        OriginalOrder(mesh_.comm, mesh_.vertices.total, vertices.first(mesh_.vertices.owned));
    mesh_.edge_order = OriginalOrder(mesh_.comm, mesh_.edges.total, edges.first(mesh_.edges.owned));
    mesh_.cell_order = OriginalOrder(mesh_.comm, mesh_.total_cells, mesh_.owned_cell_originals);
  }

  void report() {
    Global cut = 0;
    for (Local e = 0; e < mesh_.edges.owned; ++e) cut += !mesh_.owns_vertex(mesh_.edge_vertices[e][1]);
    const double mean = double(mesh_.vertices.total) / size_of(mesh_.comm);
    mesh_.report = {sum_over(mesh_.comm, cut),
                    double(max_over(mesh_.comm, Global(mesh_.vertices.owned))) / mean,
                    max_over(mesh_.comm, Global(mesh_.vertices.ghosts()))};
  }

  const MeshSlab& slab_;
  const std::vector<int>& owners_;
  DistributedMesh mesh_;
  Vec3 low_ = Vec3::Zero();
  double side_ = 1;
  std::unordered_map<Global, Local> local_of_; ///< local number of an original vertex number
};

/// What was needed only while building was allocated in small pieces, and would stay with the program.
void give_back_memory() {
#ifdef __GLIBC__
  malloc_trim(0);
#endif
}

} // namespace

/// An owned edge has an owned vertex, and all cells there are stored.
std::vector<char> find_threads(const DistributedMesh& mesh) {
  std::vector<char> is_thread(mesh.edges.size(), 0);
  for (const LocalCell& c : mesh.cells) {
    const int n = c.size();
    if (n == 3) continue;
    for (int k = 0; k < (n == 2 ? 1 : n); ++k) {
      const Local a = c.vertices[k], b = c.vertices[(k + 1) % n];
      if (!mesh.owns_vertex(a) && !mesh.owns_vertex(b)) continue;
      const Local edge = mesh.owns_vertex(a) ? edge_between(mesh, a, b) : edge_between(mesh, b, a);
      is_thread[edge] = 1;
    }
  }
  mesh.edge_halo.update(is_thread);
  return is_thread;
}

double mean_edge(const DistributedMesh& mesh) {
  double sum = 0;
  for (Local e = 0; e < mesh.edges.owned; ++e) sum += mesh.rest_lengths[e];
  return sum_over(mesh.comm, sum) / double(mesh.edges.total);
}

DistributedMesh distribute(MPI_Comm comm, const MeshSlab& mesh, const Topology& topology,
                           const std::vector<int>& owners) {
  DistributedMesh distributed = Builder(comm, mesh, owners).build(send_parts(comm, mesh, topology, owners));
  distributed.triangles_only = topology.triangles_only;
  distributed.has_triangles = topology.has_triangles;
  give_back_memory();
  return distributed;
}

DistributedMesh distribute(MPI_Comm comm, const MeshSlab& mesh, Partitioner method) {
  const Topology topology = find_topology(comm, mesh);
  return distribute(comm, mesh, topology, partition(comm, mesh, topology, method));
}

} // namespace taut
