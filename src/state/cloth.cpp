#include "src/state/cloth.hpp"

#include "src/state/material_coordinates.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>

namespace taut {

namespace {

/// m^2 of a face, m of a line element. For a quad, half the cross product of its diagonals.
double measure_of(const DistributedMesh& mesh, std::size_t cell) {
  const std::array<Vec3, 4> x = rest_corners(mesh, cell);
  switch (mesh.cells[cell].size()) {
  case 2:
    return (x[1] - x[0]).norm();
  case 3:
    return 0.5 * (x[1] - x[0]).cross(x[2] - x[0]).norm();
  default:
    return 0.5 * (x[2] - x[0]).cross(x[3] - x[1]).norm();
  }
}

/// Of local edges, the mean over the cells that have it: where pieces of texture meet they may differ. An
/// owned edge has an owned vertex, and all cells there are stored.
std::vector<double> lengths_in_texture(const DistributedMesh& mesh) {
  std::vector<double> length(mesh.edges.size(), 0.0), cells(length);
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
    const std::array<Vec3, 4> x = rest_corners(mesh, c);
    const int n = mesh.cells[c].size();
    for (int k = 0; k < n; ++k) {
      const Local a = mesh.cells[c].vertices[k], b = mesh.cells[c].vertices[(k + 1) % n];
      if (!mesh.owns_vertex(a) && !mesh.owns_vertex(b)) continue;
      const Local edge = mesh.owns_vertex(a) ? edge_between(mesh, a, b) : edge_between(mesh, b, a);
      if (edge < 0) continue;
      length[edge] += (x[(k + 1) % n] - x[k]).norm();
      cells[edge] += 1;
    }
  }
  for (std::size_t e = 0; e < length.size(); ++e) length[e] /= std::max(cells[e], 1.0);
  mesh.edge_halo.update(length);
  return length;
}

std::vector<double> rest_lengths(const DistributedMesh& mesh) {
  if (mesh.rest_in_texture) return lengths_in_texture(mesh);
  std::vector<double> length;
  for (const auto& [a, b] : mesh.edge_vertices)
    length.push_back((mesh.rest_positions[b] - mesh.rest_positions[a]).norm());
  return length;
}

} // namespace

std::size_t Cloth::piece_of_original(Global vertex) const {
  const auto after = std::upper_bound(pieces.begin(), pieces.end(), vertex,
                                      [](Global v, const Piece& p) { return v < p.first_vertex; });
  return std::size_t(after - pieces.begin()) - 1;
}

Cloth make_cloth(DistributedMesh distributed, const config::Material& material) {
  const Piece all{
      material, 0, 0, distributed.vertices.total, distributed.total_cells, distributed.triangles_only};
  return make_cloth(std::move(distributed), std::vector<Piece>{all});
}

Cloth make_cloth(DistributedMesh distributed, std::vector<Piece> pieces) {
  Cloth cloth;
  cloth.mesh = std::move(distributed);
  cloth.pieces = std::move(pieces);
  const DistributedMesh& mesh = cloth.mesh;
  cloth.measure.assign(mesh.vertices.size(), 0.0);
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
    const LocalCell& cell = mesh.cells[c];
    const double share = measure_of(mesh, c) / cell.size();
    for (int k = 0; k < cell.size(); ++k) cloth.measure[cell.vertices[k]] += share;
  }
  mesh.vertex_halo.update(cloth.measure);
  for (Local i = 0; i < mesh.vertices.size(); ++i)
    cloth.mass.push_back(cloth.pieces[cloth.piece_of(i)].material.density * cloth.measure[i]);
  cloth.rest_length = rest_lengths(mesh);
  return cloth;
}

double lowest(const Cloth& cloth, std::span<const Vec3> positions, const Vec3& down) {
  double depth = -std::numeric_limits<double>::infinity();
  for (Local i = 0; i < cloth.mesh.vertices.owned; ++i) depth = std::max(depth, positions[i].dot(down));
  return max_over(cloth.mesh.comm, depth);
}

} // namespace taut
