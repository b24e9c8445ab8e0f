#pragma once
#include "src/state/state.hpp"

/// What frames show of edges, and of faces in their place. Nothing here is collective.
namespace taut {

/// Of local edges.
std::vector<double> strains_of_edges(const Cloth& cloth, const State& state);
std::vector<double> tensions_of_edges(const Cloth& cloth, const State& state); ///< N

/// The edges along the sides of a cell, -1 where there is none: along warp (0, 2) and weft (1, 3), 0 and 3 at
/// the first corner of a quad.
std::array<Local, 4> sides_of(const DistributedMesh& mesh, Local cell);

/// A direction of the cloth.
enum class Along { warp, weft };

/// Of owned cells, what a face shows of its edges: the means over the sides along a direction.
std::vector<double> mean_over_sides(const DistributedMesh& mesh, const std::vector<double>& edge_values,
                                    Along direction);

/// Of owned cells, the strains of tangents |w| - 1, the means over those of a cell.
std::vector<double> strains_of_cells(const Cloth& cloth, std::span<const Vec3> positions, Along direction);

} // namespace taut
