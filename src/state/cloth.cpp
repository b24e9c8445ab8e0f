#include "src/state/cloth.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>

namespace taut {

namespace {

/// m^2 of a face, m of a line element. For a quad, half the cross product of its diagonals.
double measure_of(const LocalCell& cell, std::span<const Vec3> x) {
  const auto& v = cell.vertices;
  switch (cell.size()) {
  case 2:
    return (x[v[1]] - x[v[0]]).norm();
  case 3:
    return 0.5 * (x[v[1]] - x[v[0]]).cross(x[v[2]] - x[v[0]]).norm();
  default:
    return 0.5 * (x[v[2]] - x[v[0]]).cross(x[v[3]] - x[v[1]]).norm();
  }
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
  for (const LocalCell& cell : mesh.cells) {
    const double share = measure_of(cell, mesh.rest_positions) / cell.size();
    for (int k = 0; k < cell.size(); ++k) cloth.measure[cell.vertices[k]] += share;
  }
  mesh.vertex_halo.update(cloth.measure);
  for (Local i = 0; i < mesh.vertices.size(); ++i)
    cloth.mass.push_back(cloth.pieces[cloth.piece_of(i)].material.density * cloth.measure[i]);
  for (const auto& [a, b] : mesh.edge_vertices)
    cloth.rest_length.push_back((mesh.rest_positions[b] - mesh.rest_positions[a]).norm());
  return cloth;
}

double lowest(const Cloth& cloth, std::span<const Vec3> positions, const Vec3& down) {
  double depth = -std::numeric_limits<double>::infinity();
  for (Local i = 0; i < cloth.mesh.vertices.owned; ++i) depth = std::max(depth, positions[i].dot(down));
  return max_over(cloth.mesh.comm, depth);
}

} // namespace taut
