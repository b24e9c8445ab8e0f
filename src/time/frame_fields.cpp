#include "src/time/frame_fields.hpp"

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

namespace {

WarpWeft room_for(std::size_t cells) {
  WarpWeft result;
  result.warp.reserve(cells);
  result.weft.reserve(cells);
  return result;
}

} // namespace

WarpWeft mean_over_sides(const DistributedMesh& mesh, const std::vector<double>& edge_values) {
  const auto mean = [&](Local a, Local b) {
    double sum = 0;
    int count = 0;
    for (const Local e : {a, b})
      if (e >= 0) {
        sum += edge_values[e];
        ++count;
      }
    return count > 0 ? sum / count : 0.0;
  };
  WarpWeft result = room_for(mesh.owned_cells.size());
  for (const Local c : mesh.owned_cells) {
    const auto s = sides_of(mesh, c);
    result.warp.push_back(mean(s[0], s[2]));
    result.weft.push_back(mean(s[1], s[3]));
  }
  return result;
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

/// Those of its sides; what else makes up tangents would take longer.
std::array<double, 2> strains_of_quad(const DistributedMesh& mesh, Local cell,
                                      std::span<const Vec3> positions) {
  std::array<double, 2> strains{};
  const auto& v = mesh.cells[cell].vertices;
  const int first = warp_side(mesh, cell);
  for (int k = 0; k < 4; ++k) {
    const Local a = v[k], b = v[(k + 1) % 4];
    const double rest = (mesh.rest_positions[b] - mesh.rest_positions[a]).norm();
    strains[(first + k) % 2] += 0.5 * ((positions[b] - positions[a]).norm() / rest - 1.0);
  }
  return strains;
}

} // namespace

WarpWeft strains_of_cells(const Cloth& cloth, std::span<const Vec3> positions) {
  WarpWeft result = room_for(cloth.mesh.owned_cells.size());
  std::vector<Tangent> tangents; // of one cell; those of all would outweigh the mesh
  for (const Local c : cloth.mesh.owned_cells) {
    if (cloth.mesh.cells[c].size() == 4) {
      const auto [warp, weft] = strains_of_quad(cloth.mesh, c, positions);
      result.warp.push_back(warp);
      result.weft.push_back(weft);
      continue;
    }
    tangents.clear();
    append_tangents(cloth, c, tangents);
    std::array<double, 2> sum{}, count{};
    for (const Tangent& t : tangents) {
      sum[t.direction] += tangent(t.stencil, positions).norm() - 1.0;
      ++count[t.direction];
    }
    result.warp.push_back(sum[0] / std::max(1.0, count[0]));
    result.weft.push_back(sum[1] / std::max(1.0, count[1]));
  }
  return result;
}

} // namespace taut
