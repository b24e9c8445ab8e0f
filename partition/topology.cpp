#include "partition/topology.hpp"

#include "partition/fetch.hpp"
#include "partition/mesh_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <tuple>

namespace taut {

namespace {

/// One side of one cell, sent to the slab of its lower vertex.
struct CellSide {
  Global low, high;
  Global cell;
  Global line; ///< of the cell in its file, 0 if it came from none
  int cell_size;
  int runs_upwards;             ///< 1 if the cell runs from low to high along this side
  std::array<Global, 2> across; ///< the other vertices of a face; unused places hold -1
  Vec2 run;                     ///< of the texture from low to high; zero without
  double length;                ///< m, of the rest shape of the cell; zero without
  Vec2 apex;                    ///< m, in that: as of UnfoldedFaces
};

struct Edge {
  Global low, high;
  Global number; ///< among the constrained edges, -1 if not one of them
  std::array<Global, 2> cells;
  double rest_length;
  bool is_thread;
};

/// Where the middle of the other vertices is in the rest shape of a cell, seen along its side k, upwards or
/// not.
Vec2 apex_of(const Corners2& shape, int n, int k, bool upwards) {
  const Vec2 &a = shape[k], &b = shape[(k + 1) % n];
  Vec2 middle = shape[(k + 2) % n];
  if (n > 3) middle = 0.5 * (middle + shape[(k + 3) % n]);
  const Vec2 along = (b - a).normalized(), d = middle - a;
  const double t = d.dot(along), beside = std::abs(along[0] * d[1] - along[1] * d[0]);
  return {upwards ? t : (b - a).norm() - t, beside};
}

std::vector<CellSide> collect_sides(MPI_Comm comm, const MeshSlab& mesh) {
  std::vector<CellSide> sides;
  std::vector<int> to;
  sides.reserve(4 * mesh.cell.size());
  to.reserve(4 * mesh.cell.size());
  for (std::size_t c = 0; c < mesh.cell.size(); ++c) {
    const Cell& cell = mesh.cell[c];
    const int n = cell.size();
    for (int k = 0; k < (n == 2 ? 1 : n); ++k) {
      const Global a = cell.vertices[k], b = cell.vertices[(k + 1) % n];
      const Global line = mesh.cell_lines.empty() ? 0 : mesh.cell_lines[c];
      const std::array<Global, 2> across{n > 2 ? cell.vertices[(k + 2) % n] : -1,
                                         n > 3 ? cell.vertices[(k + 3) % n] : -1};
      Vec2 run = Vec2::Zero();
      if (!mesh.texture.empty()) run = (a < b ? 1 : -1) * (mesh.texture[c][(k + 1) % n] - mesh.texture[c][k]);
      double length = 0;
      Vec2 apex = Vec2::Zero();
      if (!mesh.rest_shape.empty() && n > 2) {
        const Corners2& shape = mesh.rest_shape[c];
        length = (shape[(k + 1) % n] - shape[k]).norm();
        if (length > 0) apex = apex_of(shape, n, k, a < b);
      }
      sides.push_back({std::min(a, b), std::max(a, b), mesh.cells.first + Global(c), line, n, a < b, across,
                       run, length, apex});
      to.push_back(slab_rank(mesh.vertices.total, size_of(comm), sides.back().low));
    }
  }
  sides = exchange(comm, sides, to).items;
  std::sort(sides.begin(), sides.end(), [](const CellSide& a, const CellSide& b) {
    return std::tie(a.low, a.high, a.cell) < std::tie(b.low, b.high, b.cell);
  });
  return sides;
}

/// What is wrong with the sides that make up one edge, if anything.
std::optional<std::string> fault_of(const MeshSlab& mesh, std::span<const CellSide> sides) {
  if (sides.size() == 1) return std::nullopt;
  const CellSide &one = sides[0], &two = sides[1];
  const auto edge = fmt::format("the edge between vertices {} and {}", one.low, one.high);
  const auto other = one.line > 0 ? fmt::format("line {}", one.line) : fmt::format("cell {}", one.cell);
  if (one.cell_size == 2 || two.cell_size == 2)
    return fmt::format("{}: {} is there twice (also {}); remove one of them", place(mesh, two.line), edge,
                       other);
  if (sides.size() > 2)
    return fmt::format(
        "{}: {} has {} faces (one on {}): the mesh is non-manifold there; a cloth edge has one or two "
        "faces, so separate the sheets",
        place(mesh, sides.back().line), edge, sides.size(), other);
  if (one.runs_upwards == two.runs_upwards)
    return fmt::format(
        "{}: this face and the face on {} run along {} in the same direction: one of them is flipped "
        "or doubled; orient all faces alike",
        place(mesh, two.line), other, edge);
  return std::nullopt;
}

bool has_cells(MPI_Comm comm, const MeshSlab& mesh, bool (*which)(const Cell&)) {
  return any_of(comm, std::any_of(mesh.cell.begin(), mesh.cell.end(), which));
}

/// Fills `constrained_edges` and `hinges` of `topology` on the way.
std::vector<Edge> edges_from(MPI_Comm comm, const MeshSlab& mesh, std::span<const CellSide> sides,
                             ConstrainedEdges constrained_edges, Topology& topology) {
  std::vector<Edge> edges;
  std::optional<std::string> fault;
  Global constrained = 0;
  for (std::size_t i = 0, j = 0; i < sides.size(); i = j) {
    while (j < sides.size() && sides[j].low == sides[i].low && sides[j].high == sides[i].high) ++j;
    const auto group = sides.subspan(i, j - i);
    if (!fault) fault = fault_of(mesh, group);
    const bool is_thread =
        std::any_of(group.begin(), group.end(), [](const CellSide& s) { return s.cell_size != 3; });
    const bool is_constrained =
        is_thread || topology.triangles_only || constrained_edges == ConstrainedEdges::all;
    if (group.size() == 2) {
      const CellSide &left = group[group[0].runs_upwards ? 0 : 1],
                     &right = group[group[0].runs_upwards ? 1 : 0];
      topology.hinges.push_back({left.low,
                                 left.high,
                                 left.across,
                                 right.across,
                                 {left.cell, right.cell},
                                 group[0].run,
                                 {left.length, left.apex, right.apex}});
    }
    edges.push_back({group[0].low,
                     group[0].high,
                     is_constrained ? constrained++ : -1,
                     {group[0].cell, group.size() > 1 ? group[1].cell : -1},
                     group[0].length,
                     is_thread});
  }
  agree(comm, fault);
  const Global first = exclusive_sum(comm, constrained);
  for (Edge& e : edges)
    if (e.number >= 0) e.number += first;
  topology.constrained_edges = sum_over(comm, constrained);
  return edges;
}

std::vector<Spoke> collect_spokes(MPI_Comm comm, const MeshSlab& mesh, std::span<const Edge> edges) {
  std::vector<Spoke> spokes;
  std::vector<int> to;
  spokes.reserve(2 * edges.size());
  to.reserve(2 * edges.size());
  for (const Edge& e : edges)
    for (const auto& [centre, neighbour] : {std::pair{e.low, e.high}, std::pair{e.high, e.low}}) {
      spokes.push_back({centre, neighbour, e.number, e.cells, e.rest_length, e.is_thread});
      to.push_back(slab_rank(mesh.vertices.total, size_of(comm), centre));
    }
  spokes = exchange(comm, spokes, to).items;
  std::sort(spokes.begin(), spokes.end(), [](const Spoke& a, const Spoke& b) {
    return std::tie(a.centre, a.neighbour) < std::tie(b.centre, b.neighbour);
  });
  return spokes;
}

bool share_a_cell(const Spoke& a, const Spoke& b) {
  for (const Global cell : a.cells)
    if (cell >= 0 && (cell == b.cells[0] || cell == b.cells[1])) return true;
  return false;
}

/// The only spoke of the star that continues `s`, or null.
const Spoke* partner_of(const Spoke& s, std::span<const Spoke> star) {
  const Spoke* partner = nullptr;
  for (const Spoke& t : star) {
    if (&t == &s || !t.is_thread || share_a_cell(s, t)) continue;
    if (partner) return nullptr;
    partner = &t;
  }
  return partner;
}

void append_triples(std::span<const Spoke> star, std::vector<YarnTriple>& triples) {
  for (const Spoke& s : star) {
    if (!s.is_thread) continue;
    const Spoke* t = partner_of(s, star);
    if (t && s.neighbour < t->neighbour && partner_of(*t, star) == &s)
      triples.push_back({s.neighbour, s.centre, t->neighbour});
  }
}

/// Pairs the edges of a star whose directions from the centre are most nearly opposite, straightest first;
/// such that turn by more than 60 degrees stay single. S couples edges a and b of a vertex by the cosine of
/// the angle between them, so these are the strongest couplings of which each edge has one at each end.
void append_straightest(std::span<const Spoke> star, std::span<const Vec3> directions,
                        std::vector<YarnTriple>& triples) {
  struct Pair {
    double cosine;
    std::size_t a, b;
  };
  std::vector<Pair> pairs;
  for (std::size_t a = 0; a < star.size(); ++a)
    for (std::size_t b = a + 1; b < star.size(); ++b)
      if (const double cosine = directions[a].dot(directions[b]); cosine < -0.5)
        pairs.push_back({cosine, a, b});
  std::sort(pairs.begin(), pairs.end(), [](const Pair& p, const Pair& q) {
    return std::tie(p.cosine, p.a, p.b) < std::tie(q.cosine, q.a, q.b);
  });
  std::vector<char> taken(star.size(), 0);
  for (const Pair& p : pairs) {
    if (taken[p.a] || taken[p.b]) continue;
    taken[p.a] = taken[p.b] = 1;
    triples.push_back({star[p.a].neighbour, star[p.a].centre, star[p.b].neighbour});
  }
}

/// The rest directions of all spokes of this slab, of length one.
std::vector<Vec3> directions_of(MPI_Comm comm, const MeshSlab& mesh, std::span<const Spoke> spokes) {
  std::vector<Global> neighbours;
  for (const Spoke& s : spokes) neighbours.push_back(s.neighbour);
  auto directions = fetch<Vec3>(comm, mesh.vertices, mesh.rest_positions, neighbours);
  for (std::size_t i = 0; i < spokes.size(); ++i)
    directions[i] =
        (directions[i] - mesh.rest_positions[spokes[i].centre - mesh.vertices.first]).normalized();
  return directions;
}

} // namespace

Topology find_topology(MPI_Comm comm, const MeshSlab& mesh, ConstrainedEdges constrained) {
  Topology topology;
  check_cells(comm, mesh);
  topology.triangles_only = !has_cells(comm, mesh, [](const Cell& c) { return c.size() != 3; });
  topology.has_triangles = has_cells(comm, mesh, [](const Cell& c) { return c.size() == 3; });
  {
    const auto sides = collect_sides(comm, mesh);
    const auto edges = edges_from(comm, mesh, sides, constrained, topology);
    topology.spokes = collect_spokes(comm, mesh, edges);
  }
  const auto directions =
      topology.triangles_only ? directions_of(comm, mesh, topology.spokes) : std::vector<Vec3>();
  std::optional<std::string> fault;
  topology.star.push_back(0);
  for (Global v = 0; v < mesh.vertices.count; ++v) {
    std::size_t end = topology.star.back();
    while (end < topology.spokes.size() && topology.spokes[end].centre == mesh.vertices.first + v) ++end;
    const std::span<const Spoke> star(topology.spokes.data() + topology.star.back(),
                                      end - topology.star.back());
    if (star.empty() && !fault)
      fault = fmt::format("{}: vertex {} belongs to no face and no line; remove it",
                          place(mesh, mesh.vertex_lines.empty() ? 0 : mesh.vertex_lines[v]),
                          mesh.vertices.first + v);
    if (topology.triangles_only)
      append_straightest(star, std::span(directions).subspan(topology.star.back(), star.size()),
                         topology.triples);
    else
      append_triples(star, topology.triples);
    topology.star.push_back(end);
  }
  agree(comm, fault);
  return topology;
}

} // namespace taut
