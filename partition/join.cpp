#include "partition/join.hpp"

#include <algorithm>

namespace taut {

namespace {

/// Slabs of one list behind the other, in new slabs. Items of a slab are in order, and so are the slabs of
/// the ranks: what arrives is in order as well.
class Appender {
public:
  explicit Appender(MPI_Comm comm) : comm_(comm) {}

  /// Sends each item to the rank whose slab of `total` entities holds `place(i)`.
  template<class T, class Place>
  void append(const std::vector<T>& items, Global total, Place&& place, std::vector<T>& all) const {
    std::vector<int> to;
    for (std::size_t i = 0; i < items.size(); ++i) to.push_back(slab_rank(total, size_of(comm_), place(i)));
    const auto received = exchange(comm_, items, to).items;
    all.insert(all.end(), received.begin(), received.end());
  }

private:
  MPI_Comm comm_;
};

/// Numbers of the entities of the whole that come before a mesh.
struct Before {
  Global vertices = 0, cells = 0, edges = 0;
};

void move_by(Global count, std::span<Global> numbers) {
  for (Global& n : numbers)
    if (n >= 0) n += count;
}

void number_through(ListedMesh& mesh, const Before& before) {
  for (Cell& c : mesh.slab.cell) move_by(before.vertices, c.vertices);
  for (Spoke& s : mesh.topology.spokes) {
    s.centre += before.vertices;
    s.neighbour += before.vertices;
    if (s.edge >= 0) s.edge += before.edges;
    move_by(before.cells, s.cells);
  }
  for (YarnTriple& t : mesh.topology.triples) {
    t.before += before.vertices;
    t.centre += before.vertices;
    t.after += before.vertices;
  }
  for (EdgeFaces& h : mesh.topology.hinges) {
    h.low += before.vertices;
    h.high += before.vertices;
    move_by(before.vertices, h.left);
    move_by(before.vertices, h.right);
    move_by(before.cells, h.cells);
  }
}

/// What only some meshes have, and then the whole.
struct OptionalParts {
  bool texture, rest_shape, joint;
};

void append_slab(const Appender& to_slabs, const MeshSlab& part, const Before& before,
                 const OptionalParts& has, MeshSlab& all) {
  const auto vertex = [&](std::size_t i) { return before.vertices + part.vertices.first + Global(i); };
  const auto cell = [&](std::size_t i) { return before.cells + part.cells.first + Global(i); };
  to_slabs.append(part.rest_positions, all.vertices.total, vertex, all.rest_positions);
  to_slabs.append(part.cell, all.cells.total, cell, all.cell);
  const auto append_corners = [&](auto corners, std::vector<Corners2>& all_corners) {
    if (corners.empty())
      corners.assign(part.cell.size(), {Vec2::Zero(), Vec2::Zero(), Vec2::Zero(), Vec2::Zero()});
    to_slabs.append(corners, all.cells.total, cell, all_corners);
  };
  if (has.texture) append_corners(part.texture, all.texture);
  if (has.rest_shape) append_corners(part.rest_shape, all.rest_shape);
  if (!has.joint) return;
  std::vector<Global> joint;
  for (std::size_t i = 0; i < part.rest_positions.size(); ++i)
    joint.push_back(part.joint.empty() ? vertex(i) : before.vertices + part.joint[i]);
  to_slabs.append(joint, all.vertices.total, vertex, all.joint);
}

void append_topology(const Appender& to_slabs, const Topology& part, Global vertices, Topology& all) {
  to_slabs.append(
      part.spokes, vertices, [&](std::size_t i) { return part.spokes[i].centre; }, all.spokes);
  to_slabs.append(
      part.triples, vertices, [&](std::size_t i) { return part.triples[i].centre; }, all.triples);
  to_slabs.append(
      part.hinges, vertices, [&](std::size_t i) { return part.hinges[i].low; }, all.hinges);
}

void find_stars(const Slab& vertices, Topology& topology) {
  topology.star.assign(1, 0);
  for (Global v = vertices.first; v < vertices.first + vertices.count; ++v) {
    std::size_t end = topology.star.back();
    while (end < topology.spokes.size() && topology.spokes[end].centre == v) ++end;
    topology.star.push_back(end);
  }
}

} // namespace

ListedMesh join(MPI_Comm comm, std::span<const ListedMesh> meshes) {
  ListedMesh all;
  all.topology.triangles_only = true;
  Global vertices = 0, cells = 0;
  std::array<bool, 3> found{};
  for (const ListedMesh& m : meshes) {
    vertices += m.slab.vertices.total;
    cells += m.slab.cells.total;
    found = {found[0] || !m.slab.texture.empty(), found[1] || !m.slab.rest_shape.empty(),
             found[2] || !m.slab.joint.empty()};
  }
  const OptionalParts has{any_of(comm, found[0]), any_of(comm, found[1]), any_of(comm, found[2])};
  all.slab.name = "the cloths";
  all.slab.vertices = slab_of(vertices, size_of(comm), rank_of(comm));
  all.slab.cells = slab_of(cells, size_of(comm), rank_of(comm));
  const Appender to_slabs(comm);
  Before before;
  for (ListedMesh mesh : meshes) {
    number_through(mesh, before);
    append_slab(to_slabs, mesh.slab, before, has, all.slab);
    append_topology(to_slabs, mesh.topology, vertices, all.topology);
    all.topology.triangles_only &= mesh.topology.triangles_only;
    all.topology.has_triangles |= mesh.topology.has_triangles;
    before.vertices += mesh.slab.vertices.total;
    before.cells += mesh.slab.cells.total;
    before.edges += mesh.topology.constrained_edges;
  }
  all.topology.constrained_edges = before.edges;
  find_stars(all.slab.vertices, all.topology);
  return all;
}

} // namespace taut
