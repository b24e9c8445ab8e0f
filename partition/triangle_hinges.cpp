#include "partition/triangle_hinges.hpp"

#include <algorithm>
#include <tuple>

namespace taut {

namespace {

template<class Vertex>
std::array<Vertex, 3> ascending(Vertex a, Vertex b, Vertex c) {
  std::array<Vertex, 3> corners{a, b, c};
  std::sort(corners.begin(), corners.end());
  return corners;
}

/// Of a triangle to the left or right of a hinge.
struct Side {
  std::array<Local, 3> corners;
  Local hinge;
  bool is_right;
};

std::vector<Side> sides_of_triangles(const DistributedMesh& mesh) {
  std::vector<Side> sides;
  for (std::size_t k = 0; k < mesh.hinges.size(); ++k) {
    const Hinge& h = mesh.hinges[k];
    if (h.left[1] < 0) sides.push_back({ascending(h.edge[0], h.edge[1], h.left[0]), Local(k), false});
    if (h.right[1] < 0) sides.push_back({ascending(h.edge[0], h.edge[1], h.right[0]), Local(k), true});
  }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return std::tie(a.corners, a.hinge) < std::tie(b.corners, b.hinge);
  });
  return sides;
}

TrianglePatch patch_of(const DistributedMesh& mesh, std::span<const Side> sides) {
  const auto apex = [&](const Side& s, bool is_right) {
    const Hinge& h = mesh.hinges[s.hinge];
    return is_right ? h.right[0] : h.left[0];
  };
  const auto& edge = mesh.hinges[sides[0].hinge].edge;
  TrianglePatch patch{{-1, -1, -1}, {edge[0], edge[1], apex(sides[0], sides[0].is_right)}};
  for (std::size_t k = 0; k < 3; ++k) {
    if (k < sides.size()) patch.hinges[k] = sides[k].hinge;
    patch.vertices[3 + k] = k < sides.size() ? apex(sides[k], !sides[k].is_right) : patch.vertices[2 + k];
  }
  return patch;
}

} // namespace

std::vector<Global> HingesOfTriangle::vertices() const {
  std::vector<Global> all;
  for (const EdgeFaces& h : hinges)
    for (const Global v : vertices_of(h)) all.push_back(v);
  return all;
}

std::vector<HingesOfTriangle> hinges_of_triangles(MPI_Comm comm, const Slab& vertices,
                                                  std::span<const EdgeFaces> hinges) {
  struct Sent {
    std::array<Global, 3> corners;
    EdgeFaces hinge;
  };
  std::vector<Sent> sent;
  std::vector<int> to;
  for (const EdgeFaces& h : hinges)
    for (const auto& face : {h.left, h.right}) {
      if (face[1] >= 0) continue;
      sent.push_back({ascending(h.low, h.high, face[0]), h});
      to.push_back(slab_rank(vertices.total, size_of(comm), sent.back().corners[0]));
    }
  sent = exchange(comm, sent, to).items;
  std::sort(sent.begin(), sent.end(), [](const Sent& a, const Sent& b) {
    return std::tie(a.corners, a.hinge.low, a.hinge.high) < std::tie(b.corners, b.hinge.low, b.hinge.high);
  });
  std::vector<HingesOfTriangle> triangles;
  for (const Sent& s : sent) {
    if (triangles.empty() || triangles.back().corners != s.corners) triangles.push_back({s.corners, {}});
    triangles.back().hinges.push_back(s.hinge);
  }
  return triangles;
}

std::vector<TrianglePatch> triangle_patches(const DistributedMesh& mesh) {
  const auto sides = sides_of_triangles(mesh);
  std::vector<std::span<const Side>> groups;
  for (std::size_t i = 0, j = 0; i < sides.size(); i = j) {
    while (j < sides.size() && sides[j].corners == sides[i].corners) ++j;
    groups.push_back(std::span(sides).subspan(i, j - i));
  }
  std::sort(groups.begin(), groups.end(), [](const auto& a, const auto& b) {
    return std::pair(a[0].hinge, a[0].is_right) < std::pair(b[0].hinge, b[0].is_right);
  });
  std::vector<TrianglePatch> patches;
  for (const auto& group : groups) {
    if (std::any_of(group.begin(), group.end(),
                    [&](const Side& s) { return mesh.hinges[s.hinge].size() > 4; }))
      continue;
    const TrianglePatch patch = patch_of(mesh, group);
    if (std::any_of(patch.vertices.begin(), patch.vertices.end(),
                    [&](Local v) { return mesh.owns_vertex(v); }))
      patches.push_back(patch);
  }
  return patches;
}

} // namespace taut
