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

Cloth make_cloth(DistributedMesh distributed, const config::Material& material) {
  Cloth cloth;
  cloth.mesh = std::move(distributed);
  cloth.material = material;
  const DistributedMesh& mesh = cloth.mesh;
  cloth.measure.assign(mesh.vertices.size(), 0.0);
  for (const LocalCell& cell : mesh.cells) {
    const double share = measure_of(cell, mesh.rest_positions) / cell.size();
    for (int k = 0; k < cell.size(); ++k) cloth.measure[cell.vertices[k]] += share;
  }
  mesh.vertex_halo.update(cloth.measure);
  for (const double m : cloth.measure) cloth.mass.push_back(material.density * m);
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
