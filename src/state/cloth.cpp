#include "src/state/cloth.hpp"

#include "src/state/material_coordinates.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace taut {

namespace {

/// m^2 of a face, m of a line element. For a quad, half the cross product of its diagonals.
double measure_of(int size, const std::array<Vec3, 4>& x) {
  switch (size) {
  case 2:
    return (x[1] - x[0]).norm();
  case 3:
    return 0.5 * (x[1] - x[0]).cross(x[2] - x[0]).norm();
  default:
    return 0.5 * (x[2] - x[0]).cross(x[3] - x[1]).norm();
  }
}

std::vector<Section> sections_of(std::span<const Piece> pieces) {
  std::vector<Section> sections;
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    Global next = 0; // within the piece
    for (std::size_t p = 0; p < pieces[k].own.size(); ++p) {
      const PanelMaterial& panel = pieces[k].own[p];
      if (panel.first_cell > next) sections.push_back({pieces[k].first_cell + next, k});
      sections.push_back({pieces[k].first_cell + panel.first_cell, k, p});
      next = panel.first_cell + panel.cells;
    }
    if (next < pieces[k].cells) sections.push_back({pieces[k].first_cell + next, k});
  }
  return sections;
}

} // namespace

std::size_t Cloth::section_of(Global cell) const {
  const auto after = std::upper_bound(sections.begin(), sections.end(), cell,
                                      [](Global c, const Section& s) { return c < s.first_cell; });
  return std::size_t(after - sections.begin()) - 1;
}

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
  cloth.sections = sections_of(cloth.pieces);
  const DistributedMesh& mesh = cloth.mesh;
  cloth.measure.assign(mesh.vertices.size(), 0.0);
  std::vector<double> of_panels(mesh.vertices.size(), 0.0); // kg, beyond the density of the piece
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
    const LocalCell& cell = mesh.cells[c];
    const double share = measure_of(cell.size(), corners_at_rest(mesh, c)) / cell.size();
    const Section& section = cloth.sections[cloth.section_of(mesh.cell_originals[c])];
    const double more = cloth.material_of(section).density - cloth.pieces[section.piece].material.density;
    for (int k = 0; k < cell.size(); ++k) {
      cloth.measure[cell.vertices[k]] += share;
      of_panels[cell.vertices[k]] += more * share;
    }
  }
  mesh.vertex_halo.update(cloth.measure);
  mesh.vertex_halo.update(of_panels);
  for (Local i = 0; i < mesh.vertices.size(); ++i)
    cloth.mass.push_back(cloth.pieces[cloth.piece_of(i)].material.density * cloth.measure[i] + of_panels[i]);
  cloth.rest_length = mesh.rest_lengths;
  return cloth;
}

garment::NamedParts parts_of(const Cloth& cloth) {
  const auto& pieces = cloth.pieces;
  if (pieces.size() == 1) return pieces[0].parts;
  const bool has_panels =
      std::any_of(pieces.begin(), pieces.end(), [](const Piece& p) { return !p.parts.panels.empty(); });
  garment::NamedParts all;
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    const auto& [panels, seams, labels] = pieces[k].parts;
    if (panels.empty() && has_panels) all.panels.push_back({std::to_string(k), pieces[k].first_cell});
    for (const auto& [name, first] : panels)
      all.panels.push_back({fmt::format("{}.{}", k, name), pieces[k].first_cell + first});
    const auto append = [&](const std::vector<Global>& vertices, std::vector<Global>& to) {
      for (const Global v : vertices) to.push_back(pieces[k].first_vertex + v);
    };
    for (const auto& [name, vertices] : seams)
      append(vertices,
             all.seams.emplace_back(garment::NamedSeam{fmt::format("{}.{}", k, name), {}}).vertices);
    for (const auto& [name, vertices] : labels) append(vertices, all.labels[name]);
  }
  return all;
}

double lowest(const Cloth& cloth, std::span<const Vec3> positions, const Vec3& down) {
  double depth = -std::numeric_limits<double>::infinity();
  for (Local i = 0; i < cloth.mesh.vertices.owned; ++i) depth = std::max(depth, positions[i].dot(down));
  return max_over(cloth.mesh.comm, depth);
}

} // namespace taut
