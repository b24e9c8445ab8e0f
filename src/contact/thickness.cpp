#include "src/contact/thickness.hpp"

#include "src/config/cloths.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace taut {

namespace {

/// In a flat grid of squares a vertex is 0.71 edges from the diagonal across, and more rows than edges would
/// hold apart what cannot meet.
constexpr double near_edges = 0.6;

/// Of the edges of a piece, over all ranks.
struct Edges {
  double shortest, mean; ///< m
};

Edges edges_of(const Cloth& cloth, std::size_t piece) {
  double shortest = HUGE_VAL;
  std::array<double, 2> sums{}; // m, number
  for (Local e = 0; e < cloth.mesh.edges.owned; ++e) {
    if (cloth.piece_of(cloth.mesh.edge_vertices[e][0]) != piece) continue;
    shortest = std::min(shortest, cloth.rest_length[e]);
    sums[0] += cloth.rest_length[e];
    ++sums[1];
  }
  sum_in_place(cloth.mesh.comm, sums);
  return {-max_over(cloth.mesh.comm, -shortest), sums[0] / std::max(1.0, sums[1])};
}

bool has_only_faces(const Cloth& cloth) {
  const auto is_line = [](const auto& cell) { return cell.size() == 2; };
  return !any_of(cloth.mesh.comm, std::ranges::any_of(cloth.mesh.cells, is_line));
}

double thickness_of(const Case& input, std::size_t k, const Edges& edges) {
  const config::Contact contact = input.contact.value_or(config::Contact{});
  const auto& own = input.cloths[k].thickness;
  const double most = 0.5 * edges.shortest;
  const double thickness = own ? *own : contact.thickness.value_or(std::min(0.1 * edges.mean, most));
  if (thickness > most)
    throw InputError(fmt::format(
        "{}: {}: {:.4g} m is more than half the shortest edge{} "
        "({:.4g} m), so that neighbours would push each other apart; give at most {:.4g}",
        input.file.string(), own ? config::key_of_cloth(input, k) + ".thickness" : "contact.thickness",
        thickness, input.cloths.size() > 1 ? " of " + config::name_of_cloth(input, k) : "", 2 * most, most));
  return thickness;
}

} // namespace

Thickness::Thickness(const Cloth& cloth, const Case& input)
    : cloth_(cloth), has_faces_(has_only_faces(cloth)) {
  for (std::size_t k = 0; k < cloth.pieces.size(); ++k) {
    const Edges edges = edges_of(cloth, k);
    of_piece_.push_back(thickness_of(input, k, edges));
    own_near_.push_back(std::min(near_thicknesses * of_piece_[k], near_edges * edges.shortest));
  }
  largest_ = *std::max_element(of_piece_.begin(), of_piece_.end());
  smallest_ = *std::min_element(of_piece_.begin(), of_piece_.end());
}

double Thickness::near(const Pair& pair, std::span<const Global> keys) const {
  const double most = near_thicknesses * of(pair, keys);
  if (pair.body >= 0) return most;
  const std::size_t piece = cloth_.piece_of_original(keys[pair.vertices[0]]);
  const bool is_own = piece == cloth_.piece_of_original(keys[pair.vertices[3]]);
  return is_own ? part_of(pair) * own_near_[piece] : most;
}

double Thickness::of_features(Global first, Global second) const {
  const Global cloths = cloth_.mesh.vertices.total; // keys of obstacles come after them
  if (first >= cloths) std::swap(first, second);
  const double one = of_piece_[cloth_.piece_of_original(first)];
  return second >= cloths ? one : 0.5 * (one + of_piece_[cloth_.piece_of_original(second)]);
}

} // namespace taut
