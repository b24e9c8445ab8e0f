#include "partition/mesh_parts.hpp"

#include "partition/fetch.hpp"
#include "partition/sort_unique.hpp"
#include "partition/triangle_hinges.hpp"

#include <algorithm>
#include <utility>

namespace taut {

namespace {

/// Sends each entity once to every rank that owns one of its vertices.
template<class T>
class Sender {
public:
  void add(const T& item, std::span<const int> owners) {
    ranks_.assign(owners.begin(), owners.end());
    sort_unique(ranks_);
    for (const int r : ranks_) {
      items_.push_back(item);
      to_.push_back(r);
    }
  }
  std::vector<T> send(MPI_Comm comm) const { return exchange(comm, items_, to_).items; }

private:
  std::vector<T> items_;
  std::vector<int> to_, ranks_;
};

std::vector<SentVertex> send_vertices(MPI_Comm comm, const MeshSlab& mesh, const std::vector<int>& owners) {
  std::vector<SentVertex> vertices(mesh.vertices.count);
  for (std::size_t i = 0; i < vertices.size(); ++i)
    vertices[i] = {mesh.vertices.first + Global(i), mesh.rest_positions[i],
                   mesh.joint.empty() ? mesh.vertices.first + Global(i) : mesh.joint[i]};
  return exchange(comm, vertices, owners).items;
}

std::vector<SentCell> send_cells(MPI_Comm comm, const MeshSlab& mesh, const std::vector<int>& owners) {
  std::vector<Global> wanted;
  for (const Cell& c : mesh.cell)
    wanted.insert(wanted.end(), c.vertices.begin(), c.vertices.begin() + c.size());
  const auto owner = fetch<int>(comm, mesh.vertices, owners, wanted);
  Sender<SentCell> sender;
  std::size_t at = 0;
  for (std::size_t c = 0; c < mesh.cell.size(); ++c) {
    const std::size_t n = mesh.cell[c].size();
    const Corners2 texture = mesh.texture.empty() ? Corners2() : mesh.texture[c];
    const Corners2 shape = mesh.rest_shape.empty() ? Corners2() : mesh.rest_shape[c];
    sender.add({mesh.cell[c], mesh.cells.first + Global(c), texture, shape}, std::span(owner).subspan(at, n));
    at += n;
  }
  return sender.send(comm);
}

/// Stars go, as edges and triples, to the owners of their vertices.
void send_stars(MPI_Comm comm, const MeshSlab& mesh, const Topology& topology, const std::vector<int>& owners,
                MeshParts& parts) {
  std::vector<Global> wanted;
  for (const Spoke& s : topology.spokes) wanted.push_back(s.neighbour);
  const auto owner = fetch<int>(comm, mesh.vertices, owners, wanted);
  Sender<SentEdge> edges;
  Sender<YarnTriple> triples;
  std::vector<int> around;
  auto triple = topology.triples.begin();
  for (Global v = 0; v < mesh.vertices.count; ++v) {
    around.assign(owner.begin() + topology.star[v], owner.begin() + topology.star[v + 1]);
    around.push_back(owners[v]);
    for (std::size_t i = topology.star[v]; i < topology.star[v + 1]; ++i) {
      const Spoke& s = topology.spokes[i];
      if (s.edge >= 0)
        edges.add({s.edge, std::min(s.centre, s.neighbour), std::max(s.centre, s.neighbour), s.rest_length},
                  around);
    }
    for (; triple != topology.triples.end() && triple->centre == mesh.vertices.first + v; ++triple)
      triples.add(*triple, around);
  }
  parts.edges = edges.send(comm);
  parts.triples = triples.send(comm);
  std::sort(parts.edges.begin(), parts.edges.end(),
            [](const SentEdge& a, const SentEdge& b) { return a.original < b.original; });
  const auto same = [](const SentEdge& a, const SentEdge& b) { return a.original == b.original; };
  parts.edges.erase(std::unique(parts.edges.begin(), parts.edges.end(), same), parts.edges.end());
}

/// Hinges go to the owners of their vertices; those of a triangle all together, for the curvature of the
/// triangle is made of them.
std::vector<EdgeFaces> send_hinges(MPI_Comm comm, const MeshSlab& mesh, const Topology& topology,
                                   const std::vector<int>& owners) {
  const auto triangles = hinges_of_triangles(comm, mesh.vertices, topology.hinges);
  std::vector<Global> wanted;
  for (const EdgeFaces& h : topology.hinges)
    for (const Global v : vertices_of(h)) wanted.push_back(v);
  for (const HingesOfTriangle& t : triangles)
    for (const Global v : t.vertices()) wanted.push_back(v);
  const auto owner = fetch<int>(comm, mesh.vertices, owners, wanted);
  Sender<EdgeFaces> sender;
  std::span<const int> next(owner);
  const auto take = [&next](std::size_t n) { return std::exchange(next, next.subspan(n)).first(n); };
  for (const EdgeFaces& h : topology.hinges) sender.add(h, take(6));
  for (const HingesOfTriangle& t : triangles) {
    const auto around = take(6 * t.hinges.size());
    for (const EdgeFaces& h : t.hinges) sender.add(h, around);
  }
  auto hinges = sender.send(comm);
  const auto edge = [](const EdgeFaces& h) { return std::pair(h.low, h.high); };
  std::sort(hinges.begin(), hinges.end(),
            [&](const EdgeFaces& a, const EdgeFaces& b) { return edge(a) < edge(b); });
  hinges.erase(std::unique(hinges.begin(), hinges.end(),
                           [&](const EdgeFaces& a, const EdgeFaces& b) { return edge(a) == edge(b); }),
               hinges.end());
  return hinges;
}

std::vector<VertexPair> send_seams(MPI_Comm comm, const MeshSlab& mesh, const std::vector<int>& owners) {
  const auto owner = fetch<int>(comm, mesh.vertices, owners, mesh.joint);
  Sender<VertexPair> sender;
  for (std::size_t i = 0; i < mesh.joint.size(); ++i)
    if (const Global v = mesh.vertices.first + Global(i); mesh.joint[i] != v)
      sender.add({v, mesh.joint[i]}, std::array{owners[i], owner[i]});
  return sender.send(comm);
}

/// All ranks know all; they keep what they own an end of.
std::vector<VertexPair> own_ties(MPI_Comm comm, const MeshSlab& mesh, const std::vector<int>& owners) {
  std::vector<Global> ends;
  for (const VertexPair& tie : mesh.ties) ends.insert(ends.end(), tie.begin(), tie.end());
  const auto owner = fetch<int>(comm, mesh.vertices, owners, ends);
  std::vector<VertexPair> own;
  for (std::size_t k = 0; k < mesh.ties.size(); ++k)
    if (owner[2 * k] == rank_of(comm) || owner[2 * k + 1] == rank_of(comm)) own.push_back(mesh.ties[k]);
  return own;
}

} // namespace

MeshParts send_parts(MPI_Comm comm, const MeshSlab& mesh, const Topology& topology,
                     const std::vector<int>& owners) {
  MeshParts parts;
  parts.vertices = send_vertices(comm, mesh, owners);
  parts.cells = send_cells(comm, mesh, owners);
  send_stars(comm, mesh, topology, owners, parts);
  parts.hinges = send_hinges(comm, mesh, topology, owners);
  parts.seams = send_seams(comm, mesh, owners);
  parts.ties = own_ties(comm, mesh, owners);
  return parts;
}

} // namespace taut
