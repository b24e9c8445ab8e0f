#include "src/output/strain_fields.hpp"

#include "src/forces/stretch.hpp"
#include "src/state/material_coordinates.hpp"

#include <algorithm>

namespace taut {

std::array<Local, 4> sides_of(const DistributedMesh& mesh, Local cell) {
  std::array<Local, 4> sides{-1, -1, -1, -1};
  const auto& v = mesh.cells[cell].vertices;
  const int n = mesh.cells[cell].size();
  for (int k = 0; k < (n == 2 ? 1 : n); ++k) sides[k] = edge_between(mesh, v[k], v[(k + 1) % n]);
  if (n == 4 && warp_side(mesh, cell) == 1) std::reverse(sides.begin(), sides.end());
  return sides;
}

std::vector<double> mean_over_sides(const DistributedMesh& mesh, const std::vector<double>& edge_values,
                                    Along direction) {
  std::vector<double> means;
  means.reserve(mesh.owned_cells.size());
  for (const Local c : mesh.owned_cells) {
    const auto sides = sides_of(mesh, c);
    const int first = int(direction);
    double sum = 0;
    int count = 0;
    for (const Local e : {sides[first], sides[first + 2]})
      if (e >= 0) {
        sum += edge_values[e];
        ++count;
      }
    means.push_back(count > 0 ? sum / count : 0.0);
  }
  return means;
}

std::vector<double> strains_of_edges(const Cloth& cloth, const State& state) {
  std::vector<double> strains(cloth.mesh.edges.size());
  for (std::size_t e = 0; e < strains.size(); ++e) strains[e] = strain_of(cloth, state.positions, Local(e));
  return strains;
}

std::vector<double> tensions_of_edges(const Cloth& cloth, const State& state) {
  std::vector<double> tensions = strains_of_edges(cloth, state);
  for (std::size_t e = 0; e < tensions.size(); ++e)
    tensions[e] = state.multipliers.force_density[e] * cloth.rest_length[e] * (1.0 + tensions[e]);
  return tensions;
}

namespace {

/// That of its sides; what else makes up tangents would take longer.
double strain_of_quad(const DistributedMesh& mesh, Local cell, std::span<const Vec3> positions,
                      Along direction) {
  double strain = 0;
  const auto rest = corners_at_rest(mesh, std::size_t(cell));
  const auto& v = mesh.cells[cell].vertices;
  const int first = warp_side(mesh, cell);
  for (int k = 0; k < 4; ++k) {
    if ((first + k) % 2 != int(direction)) continue;
    const int next = (k + 1) % 4;
    strain += 0.5 * ((positions[v[next]] - positions[v[k]]).norm() / (rest[next] - rest[k]).norm() - 1.0);
  }
  return strain;
}

} // namespace

std::vector<double> strains_of_cells(const Cloth& cloth, std::span<const Vec3> positions, Along direction) {
  std::vector<double> strains;
  strains.reserve(cloth.mesh.owned_cells.size());
  std::vector<Tangent> tangents; // of one cell; those of all would outweigh the mesh
  for (const Local c : cloth.mesh.owned_cells) {
    if (cloth.mesh.cells[c].size() == 4) {
      strains.push_back(strain_of_quad(cloth.mesh, c, positions, direction));
      continue;
    }
    tangents.clear();
    append_tangents(cloth, c, tangents);
    double sum = 0, count = 0;
    for (const Tangent& t : tangents) {
      if (t.direction != int(direction)) continue;
      sum += tangent(t.stencil, positions).norm() - 1.0;
      ++count;
    }
    strains.push_back(sum / std::max(1.0, count));
  }
  return strains;
}

} // namespace taut
