#include "src/time/stretch_handover.hpp"

#include "src/forces/stretch.hpp"

namespace taut {

StretchHandover::StretchHandover(const Cloth& cloth, const Resolved& resolved)
    : cloth_(cloth), metric_(cloth), stiffness_(cloth.mesh.vertices.size(), Vec2::Zero()) {
  for (const Tangent& t : tangents_of(cloth)) {
    if (cloth.mesh.cells[t.cell].size() != 3) continue;
    const double stiffness =
        resolved.stretch[cloth.section_of(cloth.mesh.cell_originals[t.cell])][t.direction];
    for (const Local v : t.stencil.vertices)
      if (metric_.has(v)) stiffness_[v][t.direction] += t.measure / (3 * metric_.area(v)) * stiffness;
  }
  stiffness_.resize(cloth.mesh.vertices.owned);
  predicted_.resize(cloth.mesh.vertices.owned);
}

Vec2 StretchHandover::tension(Local vertex, std::span<const Vec3> positions) const {
  if (!metric_.has(vertex)) return Vec2::Zero();
  return stiffness_[vertex].cwiseProduct(metric_.at(vertex, positions).cwiseSqrt() - Vec2::Ones());
}

void StretchHandover::start(std::span<const Vec3> positions) {
  for (Local i = 0; i < cloth_.mesh.vertices.owned; ++i) predicted_[i] = tension(i, positions);
}

void StretchHandover::add_to(Candidate& candidate) const {
  const DistributedMesh& mesh = cloth_.mesh;
  std::vector<Vec2> taken(mesh.vertices.size(), Vec2::Zero());
  for (Local i = 0; i < mesh.vertices.owned; ++i) taken[i] = predicted_[i] - tension(i, candidate.positions);
  mesh.vertex_halo.update(taken);
  for (std::size_t i = 0; i < taken.size(); ++i) candidate.multipliers.stress[i] += taken[i];
  std::vector<double>& density = candidate.multipliers.force_density;
  for (Local e = 0; e < mesh.edges.owned; ++e) density[e] += metric_.on_edge(e, metric_.areas(), taken);
  mesh.edge_halo.update(density);
}

} // namespace taut
